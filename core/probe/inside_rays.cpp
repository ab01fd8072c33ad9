#include "core/probe/inside_rays.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/probe/posed_mesh.h"

namespace msbvh {
namespace {

constexpr int kTries = 8;

// All rays of one point inside.
class Source {
 public:
  Source(const PosedMesh& mesh, float time, const Vec3f& point, ProbeRandom& random)
      : mesh_(mesh), time_(time), point_(point), random_(random), in_plane_(point) {
    find_plane();
  }

  Ray ray(InsideAim aim) {
    if (aim == InsideAim::kAnywhere) return from(point_, random_.direction());
    if (aim == InsideAim::kInPlanes) return in_plane();
    const std::array<Vec3d, 3> v = mesh_.corners(mesh_.random_triangle(random_));
    const std::size_t k = random_.below(3);
    const Vec3d &a = v[k], &b = v[(k + 1) % 3], &c = v[(k + 2) % 3];
    if (aim == InsideAim::kVertices) return from(point_, a - Vec3d(point_));
    if (aim == InsideAim::kEdges) return from(point_, a + (b - a) * random_.uniform() - Vec3d(point_));
    if (aim == InsideAim::kAlongFaces)
      return from(point_, (b - a) * random_.uniform(-1.0, 1.0) + (c - a) * random_.uniform(-1.0, 1.0));
    const Vec3f start(a + (b - a) * random_.uniform(0.0, 0.5) + (c - a) * random_.uniform(0.0, 0.5));
    return from(start, Vec3d(point_) - Vec3d(start));
  }

 private:
  // A coordinate of a vertex, with the kernel's own rounding where it needs no map.
  float coordinate(std::uint32_t vertex, const Vec3d& exact) const {
    if (mesh_.shown().instance != kNoInstance) return static_cast<float>(exact[axis_]);
    return mesh_.shown().mesh->position(vertex, static_cast<float>(mesh_.pose().time01))[axis_];
  }
  // Moves the point into a plane in which a vertex lies, and with it the side of a box, where that is inside.
  void find_plane() {
    for (int i = 0; i < kTries; ++i) {
      axis_ = static_cast<int>(random_.below(3));
      const std::uint32_t triangle = mesh_.random_triangle(random_);
      const std::size_t k = random_.below(3);
      Vec3f moved = point_;
      moved[axis_] = coordinate(mesh_.shown().mesh->triangles[triangle][k], mesh_.corners(triangle)[k]);
      if (!mesh_.surrounds(Vec3d(moved))) continue;
      in_plane_ = moved;
      return;
    }
  }
  Ray in_plane() {
    Ray result = from(in_plane_, random_.direction());
    result.dir[axis_] = 0.0f;
    const int other = (axis_ + 1 + static_cast<int>(random_.below(2))) % 3;
    if (random_.below(2) == 0) result.dir[other] = 0.0f;
    return result;
  }
  // Never without a direction: a point of the surface is not inside, a flat triangle has directions left.
  Ray from(const Vec3f& start, const Vec3d& way) {
    Ray result;
    result.org = start;
    result.dir = Vec3f(way);
    if (dot(result.dir, result.dir) == 0.0f) result.dir = Vec3f(random_.direction());
    result.time = time_;
    return result;
  }

  const PosedMesh& mesh_;
  const float time_;
  const Vec3f point_;
  ProbeRandom& random_;
  Vec3f in_plane_;
  int axis_ = 0;
};

}  // namespace

const char* inside_aim_name(InsideAim aim) {
  constexpr const char* kNames[] = {"in any direction", "at edges",     "at vertices",
                                    "along faces",      "from surface", "in planes of boxes"};
  return kNames[static_cast<std::size_t>(aim)];
}

void add_inside_rays(const ShownMeshes& all, const ShownMesh& shown, std::size_t count, InsideMix mix,
                     ProbeRandom& random, InsideRays& out) {
  const bool plain = mix == InsideMix::kPlain;
  const float time = plain ? static_cast<float>(random.uniform()) : random.time();
  const std::optional<MeshPose> pose = all.pose(shown, double(time));
  if (!pose) return;
  const PosedMesh mesh(shown, *pose);
  const std::optional<Vec3f> point = mesh.point_inside(random);
  if (!point) return;
  Source source(mesh, time, *point, random);
  for (std::size_t i = 0; i < count; ++i) {
    const InsideAim aim = plain ? InsideAim::kAnywhere : kInsideAims[i % std::size(kInsideAims)];
    out.rays.push_back(source.ray(aim));
    out.aims.push_back(aim);
    out.from.push_back(&shown);
  }
}

InsideRays inside_rays(const ShownMeshes& all, const std::vector<const ShownMesh*>& closed,
                       std::size_t starts, std::size_t count, std::uint64_t seed, InsideMix mix) {
  ProbeRandom random(seed);
  InsideRays rays;
  for (const ShownMesh* shown : closed) {
    for (std::size_t i = 0; i < starts; ++i)
      add_inside_rays(all, *shown, std::max<std::size_t>(1, count / (closed.size() * starts)), mix, random,
                      rays);
  }
  return rays;
}

}  // namespace msbvh
