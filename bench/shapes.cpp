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

namespace {

// `at(vertex, u)` is the vertex's place at u in [0, 1].
template <typename Set, typename At>
void set_controls(Set& set, const TrackForm& form, std::uint32_t count, const std::vector<float>& radii,
                  const At& at) {
  set.segments = form.segments;
  set.degree = form.degree;
  set.vertices.resize(std::size_t(form.controls()) * count);
  const auto nodes = fit_nodes(form.degree);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!form.moving()) set.vertices[v] = {Vec3f(at(v, 0.5)), radii[v]};
    for (std::uint32_t k = 0; k < form.segments; ++k) {
      Vec3d values[kMaxDegree + 1];
      for (std::uint32_t i = 0; i <= form.degree; ++i) values[i] = at(v, (k + nodes[i]) / form.segments);
      controls_from_values([&](std::uint32_t i) -> Vec3d& { return values[i]; }, form.degree);
      for (std::uint32_t i = 0; i <= form.degree; ++i)
        set.vertices[std::size_t(k * form.degree + i) * count + v] = {Vec3f(values[i]), radii[v]};
    }
  }
}

// Chains of spans that share their ends; a strand is `spans` long.
void chain(CurveSet& curves, std::uint32_t strands, std::uint32_t spans) {
  for (std::uint32_t s = 0; s < strands; ++s) {
    for (std::uint32_t i = 0; i < spans; ++i) curves.spans.push_back(s * (3 * spans + 1) + 3 * i);
  }
}

}  // namespace

Vec3d turned(const Vec3d& v, const Vec3d& axis, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0 - c));
}

CurveSet hairs(std::uint32_t count, std::uint32_t spans, float width, const TrackForm& form, Random& random) {
  const std::uint32_t each = 3 * spans + 1;
  std::vector<Vec3d> rest, axes, roots;
  std::vector<float> radii;
  for (std::uint32_t h = 0; h < count; ++h) {
    const Vec3d out(random.direction());
    const Vec3d bend(random.direction()), curl(random.direction());
    const double length = random.uniform(0.3f, 0.5f), phase = 6.28 * random.uniform();
    roots.push_back(out * 0.6);
    axes.push_back(normalize(cross(out, bend) + out * 1e-3));
    for (std::uint32_t i = 0; i < each; ++i) {
      const double along = double(i) / (each - 1);
      const double wave = 0.03 * along * std::sin(phase + 9.0 * along);
      rest.push_back(roots.back() + out * (length * along) + bend * (0.15 * along * along) + curl * wave);
      radii.push_back(0.5f * width * static_cast<float>(1.0 - 0.8 * along));
    }
  }
  CurveSet curves;
  curves.name = "hair";
  curves.vertex_count = count * each;
  chain(curves, count, spans);
  set_controls(curves, form, curves.vertex_count, radii, [&](std::uint32_t v, double u) {
    const Vec3d& root = roots[v / each];
    return root + turned(rest[v] - root, axes[v / each], 0.5 * (u - 0.5));
  });
  return curves;
}

CurveSet blades(std::uint32_t count, const TrackForm& form, Random& random) {
  constexpr std::uint32_t kSpans = 2, kEach = 3 * kSpans + 1;
  std::vector<Vec3d> roots, leans;
  std::vector<float> heights, radii;
  for (std::uint32_t b = 0; b < count; ++b) {
    roots.push_back(Vec3d(random.in_box({-1, 0, -1}, {1, 0, 1})));
    leans.push_back(Vec3d(random.in_box({-0.5f, 0, -0.5f}, {0.5f, 0, 0.5f})));
    heights.push_back(random.uniform(0.05f, 0.12f));
    for (std::uint32_t i = 0; i < kEach; ++i)
      radii.push_back(0.002f * (1.0f - static_cast<float>(i) / kEach));
  }
  CurveSet curves;
  curves.name = "grass";
  curves.vertex_count = count * kEach;
  chain(curves, count, kSpans);
  set_controls(curves, form, curves.vertex_count, radii, [&](std::uint32_t v, double u) {
    const std::uint32_t b = v / kEach;
    const double along = double(v % kEach) / (kEach - 1), h = heights[b];
    const double wind = 0.4 * std::sin(4.0 * roots[b].x + 3.0 * u);
    const Vec3d lean = leans[b] + Vec3d{wind, 0.0, 0.3 * wind};
    return roots[b] + Vec3d{0.0, h * along, 0.0} + lean * (h * along * along);
  });
  return curves;
}

PointSet balls(std::uint32_t count, const TrackForm& form, Random& random) {
  const float radius = 0.4f / std::cbrt(static_cast<float>(count));
  std::vector<Vec3d> places, velocities;
  std::vector<float> radii;
  for (std::uint32_t i = 0; i < count; ++i) {
    places.push_back(Vec3d(random.in_box({-1, -1, -1}, {1, 1, 1})));
    velocities.push_back(Vec3d(random.direction() * random.uniform(0.0f, 0.2f)));
    radii.push_back(radius * random.uniform(0.5f, 1.5f));
  }
  PointSet points;
  points.name = "particles";
  points.point_count = count;
  set_controls(points, form, count, radii,
               [&](std::uint32_t v, double u) { return places[v] + velocities[v] * (u - 0.5); });
  return points;
}

}  // namespace msbvh::bench
