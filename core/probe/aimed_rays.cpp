#include "core/probe/aimed_rays.h"

#include <algorithm>
#include <optional>

#include "core/probe/probe_random.h"
#include "core/probe/shown.h"

namespace msbvh {
namespace {

Box3d box_of(const Bvh& world) {
  Box3d box;
  for (const Box3f& bounds : world.root_bounds) {
    box.grow(Vec3d(bounds.lo));
    box.grow(Vec3d(bounds.hi));
  }
  return box;
}

class Aimer {
 public:
  Aimer(const Bvh& world, Aim aim, std::uint64_t seed)
      : shown_(world), aim_(aim), random_(seed), box_(box_of(world)), around_(box_) {
    const Vec3d room = (box_.hi - box_.lo) * 0.5;
    around_.grow(box_.lo - room);
    around_.grow(box_.hi + room);
  }

  bool has_targets() const { return aim_ == Aim::kAnywhere || shown_.triangle_count() > 0; }

  // None: what was to be aimed at is not there at this time.
  std::optional<Ray> next() {
    const float time = random_.time();
    if (aim_ == Aim::kAnywhere) return ray(random_.in_box(around_), random_.in_box(box_), time);
    const auto [shown, triangle] = shown_.triangle(random_.below(shown_.triangle_count()));
    const std::optional<MeshPose> pose = shown_.pose(*shown, double(time));
    if (!pose) return std::nullopt;
    return at_triangle(corners(*shown, *pose, triangle), time);
  }

 private:
  Ray at_triangle(const std::array<Vec3d, 3>& c, float time) {
    const std::size_t k = random_.below(3);
    const Vec3d &a = c[k], &b = c[(k + 1) % 3];
    if (aim_ == Aim::kVertices) return ray(random_.in_box(around_), a, time);
    if (aim_ == Aim::kEdges) return ray(random_.in_box(around_), a + (b - a) * random_.uniform(), time);
    const Vec3d inside =
        a + (b - a) * random_.uniform(0.0, 0.5) + (c[(k + 2) % 3] - a) * random_.uniform(0.0, 0.5);
    if (aim_ == Aim::kFromSurfaces)
      return ray(inside, inside + random_.direction() * length(around_.hi - around_.lo), time);
    const Vec3d along =
        (b - a) * random_.uniform(-1.0, 1.0) + (c[(k + 2) % 3] - a) * random_.uniform(-1.0, 1.0);
    const double size = std::max(length(along), 1e-30);
    return ray(inside - along * (random_.uniform(0.0, 1.0) * length(around_.hi - around_.lo) / size), inside,
               time);
  }
  Ray ray(const Vec3d& from, const Vec3d& to, float time) {
    Ray result;
    result.org = Vec3f(from);
    result.dir = Vec3f(to - Vec3d(result.org));
    result.time = time;
    if (random_.below(4) == 0) result.tfar = static_cast<float>(random_.uniform(0.0, 2.0));
    return result;
  }

  const ShownMeshes shown_;
  const Aim aim_;
  ProbeRandom random_;
  const Box3d box_;
  Box3d around_;
};

}  // namespace

const char* aim_name(Aim aim) {
  constexpr const char* kNames[] = {"anywhere", "at edges", "at vertices", "along faces", "from surfaces"};
  return kNames[static_cast<std::size_t>(aim)];
}

std::vector<Ray> aimed_rays(const Bvh& world, Aim aim, std::size_t count, std::uint64_t seed) {
  std::vector<Ray> rays;
  if (world.empty) return rays;
  Aimer aimer(world, aim, seed);
  if (!aimer.has_targets()) return rays;
  rays.reserve(count);
  // What is there for a part of the shutter only takes several tries; what never is takes them all.
  for (std::size_t tries = 0; rays.size() < count && tries < 16 * count; ++tries) {
    if (const std::optional<Ray> ray = aimer.next()) rays.push_back(*ray);
  }
  return rays;
}

}  // namespace msbvh
