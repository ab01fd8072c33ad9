#include "tests/support/cages.h"

#include <cmath>
#include <utility>

namespace msbvh::procedural {
namespace {

SubdivisionMesh cage(std::vector<Vec3f> positions, std::vector<std::vector<std::uint32_t>> faces) {
  SubdivisionMesh out;
  out.name = "cage";
  out.vertex_count = static_cast<std::uint32_t>(positions.size());
  out.positions = std::move(positions);
  for (const auto& f : faces) {
    out.face_vertex_counts.push_back(static_cast<std::uint32_t>(f.size()));
    out.face_vertex_indices.insert(out.face_vertex_indices.end(), f.begin(), f.end());
  }
  return out;
}

}  // namespace

SubdivisionMesh cube_cage() {
  std::vector<Vec3f> p;
  for (int i = 0; i < 8; ++i) p.emplace_back(i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f);
  return cage(std::move(p),
              {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

SubdivisionMesh sheet_cage(int side, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> p;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto id = [&](int r, int c) { return static_cast<std::uint32_t>(r * (side + 1) + c); };
  for (int r = 0; r <= side; ++r) {
    for (int c = 0; c <= side; ++c) {
      const Vec3f at{2.f * float(c) / float(side) - 1.f, 2.f * float(r) / float(side) - 1.f, 0.f};
      p.push_back(at + random.in_box({-.1f, -.1f, -.4f}, {.1f, .1f, .4f}));
      if (r < side && c < side) faces.push_back({id(r, c), id(r, c + 1), id(r + 1, c + 1), id(r + 1, c)});
    }
  }
  return cage(std::move(p), std::move(faces));
}

SubdivisionMesh prism_cage(int sides) {
  std::vector<Vec3f> p;
  std::vector<std::vector<std::uint32_t>> faces(2);
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) {
    const float a = 6.2831853f * float(i) / float(n);
    p.emplace_back(std::cos(a), std::sin(a), -0.8f);
    p.emplace_back(std::cos(a), std::sin(a), 0.8f);
    faces[0].push_back(2 * (n - 1 - i));
    faces[1].push_back(2 * i + 1);
    const std::uint32_t j = (i + 1) % n;
    faces.push_back({2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
  }
  return cage(std::move(p), std::move(faces));
}

SubdivisionMesh octahedron_cage() {
  return cage({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
              {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

SubdivisionMesh moved(SubdivisionMesh centre_pose, const TrackForm& form, const Motion& motion,
                      const Vec3d& offset) {
  const std::vector<Vec3f> still = centre_pose.positions;
  centre_pose.segments = form.segments;
  centre_pose.degree = form.degree;
  centre_pose.positions.clear();
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    const double u = form.moving() ? double(c) / (form.controls() - 1) : 0.5;
    for (const Vec3f& p : still) centre_pose.positions.push_back(Vec3f(motion(Vec3d(p), u) + offset));
  }
  return centre_pose;
}

std::function<double(const SurfacePoint&)> bumps(double amplitude, double wave_length, const Vec3d& origin) {
  const double k = 6.283185307179586 / wave_length;
  return [=](const SurfacePoint& at) {
    const Vec3d p = (at.position - origin) * k;
    return amplitude * std::sin(p.x) * std::cos(p.y) * std::sin(p.z + 0.7);
  };
}

}  // namespace msbvh::procedural
