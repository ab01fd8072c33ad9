#include "bench/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msbvh::bench {
namespace {

constexpr float kTwoPi = 2.0f * std::numbers::pi_v<float>;

int rings_for(std::uint32_t triangles) {
  return std::max(4, static_cast<int>(std::sqrt(static_cast<double>(triangles) / 4.0)) + 1);
}

Pose pose_of(TriangleMesh mesh) {
  mesh.positions.resize(mesh.vertex_count);
  return {std::move(mesh.positions), std::move(mesh.triangles)};
}

// Any vector that is not along `axis`, made perpendicular to it.
Vec3f across(const Vec3f& axis) {
  return normalize(cross(axis, std::abs(axis.x) < 0.8f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0}));
}

}  // namespace

Pose bumpy_sphere(std::uint32_t triangles, float roughness, Random& random) {
  Pose pose = pose_of(procedural::sphere(rings_for(triangles)));
  const Vec3f phase = random.in_box({0, 0, 0}, {6, 6, 6});
  for (Vec3f& p : pose.positions) {
    const float large =
        std::sin(5 * p.x + phase.x) * std::sin(6 * p.y + phase.y) * std::sin(4 * p.z + phase.z);
    const float small = std::sin(61 * p.x + phase.y) * std::sin(53 * p.y + phase.z) * std::sin(47 * p.z);
    p = p * (1.0f + roughness * (0.7f * large + 0.3f * small));
  }
  return pose;
}

Pose cube_shell(std::uint32_t triangles, float half) {
  Pose pose = pose_of(procedural::sphere(rings_for(triangles)));
  for (Vec3f& p : pose.positions) {
    const Vec3f a = abs(p);
    p = p * (half / std::max({a.x, a.y, a.z}));
  }
  return pose;
}

void add_bar(Pose& pose, const Vec3f& a, const Vec3f& b, float thickness) {
  const auto first = static_cast<std::uint32_t>(pose.positions.size());
  const Vec3f axis = normalize(b - a), x = across(axis), y = cross(axis, x);
  for (const Vec3f& end : {a, b}) {
    for (int corner = 0; corner < 3; ++corner) {
      const float angle = kTwoPi * static_cast<float>(corner) / 3.0f;
      pose.positions.push_back(end + (x * std::cos(angle) + y * std::sin(angle)) * thickness);
    }
  }
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::uint32_t d = (c + 1) % 3;
    pose.triangles.push_back({first + c, first + d, first + 3 + d});
    pose.triangles.push_back({first + c, first + 3 + d, first + 3 + c});
  }
}

Pose strands(std::uint32_t triangles, Random& random) {
  constexpr std::uint32_t kRows = 6;
  Pose pose;
  for (std::uint32_t s = 0; s < triangles / 10; ++s) {
    const Vec3f out = random.direction(), breakpoint = random.direction() * random.uniform(0.1f, 0.5f);
    const Vec3f side = normalize(cross(out, random.direction())) * 0.0015f;
    const float reach = random.uniform(0.5f, 0.9f);
    const auto first = static_cast<std::uint32_t>(pose.positions.size());
    for (std::uint32_t row = 0; row < kRows; ++row) {
      const float along = static_cast<float>(row) / (kRows - 1);
      const Vec3f p = out * (0.4f + reach * along) + breakpoint * (along * along);
      pose.positions.push_back(p - side * (1.0f - 0.9f * along));
      pose.positions.push_back(p + side * (1.0f - 0.9f * along));
    }
    for (std::uint32_t i = first; i < first + 2 * kRows - 2; i += 2) {
      pose.triangles.push_back({i, i + 1, i + 2});
      pose.triangles.push_back({i + 1, i + 3, i + 2});
    }
  }
  return pose;
}

Pose shards(std::uint32_t triangles, Random& random) {
  Pose pose;
  const std::uint32_t count = std::max(1u, triangles / 4);
  const float size = 0.6f / std::cbrt(static_cast<float>(count));
  for (std::uint32_t s = 0; s < count; ++s) {
    const Vec3f center = random.in_box({-1, -1, -1}, {1, 1, 1});
    const std::uint32_t i = 4 * s;
    for (int v = 0; v < 4; ++v) pose.positions.push_back(center + random.direction() * size);
    pose.triangles.insert(pose.triangles.end(),
                          {{i, i + 1, i + 2}, {i, i + 2, i + 3}, {i, i + 3, i + 1}, {i + 1, i + 3, i + 2}});
  }
  return pose;
}

Pose wheels(std::uint32_t triangles, Random& random, std::vector<Wheel>& placed) {
  constexpr int kSpokes = 48, kRim = 96;
  Pose pose;
  const std::uint32_t count = std::max(1u, triangles / (6 * (kSpokes + kRim)));
  const float radius = 0.6f / std::cbrt(static_cast<float>(count));
  for (std::uint32_t w = 0; w < count; ++w) {
    const Vec3f hub = count == 1 ? Vec3f{} : random.in_box({-1, -1, -1}, {1, 1, 1});
    const Vec3f axis = random.direction(), x = across(axis), y = cross(axis, x);
    const auto rim = [&](int i, int of) {
      const float angle = kTwoPi * static_cast<float>(i) / static_cast<float>(of);
      return hub + (x * std::cos(angle) + y * std::sin(angle)) * radius;
    };
    for (int i = 0; i < kSpokes; ++i) add_bar(pose, hub, rim(i, kSpokes), 0.004f * radius);
    for (int i = 0; i < kRim; ++i) add_bar(pose, rim(i, kRim), rim(i + 1, kRim), 0.02f * radius);
    placed.push_back({Vec3d(hub), Vec3d(axis)});
  }
  return pose;
}

}  // namespace msbvh::bench
