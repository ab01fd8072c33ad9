#include "bench/scenes.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace msbvh::bench {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// std::uniform_real_distribution differs between standard libraries; this does not.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float in(float lo, float hi) { return lo + (hi - lo) * (static_cast<float>(engine_() >> 8) * 0x1p-24f); }
  Vec3f in_cube(float half) { return {in(-half, half), in(-half, half), in(-half, half)}; }

 private:
  std::mt19937 engine_;
};

// Turns about an axis of unit length: Rodrigues' formula.
Vec3f turned(const Vec3f& p, const Vec3f& axis, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return p * c + cross(axis, p) * s + axis * (dot(axis, p) * (1.0f - c));
}

Vec3f unit(const Vec3f& v) { return v * (1.0f / std::sqrt(dot(v, v))); }

// `position(vertex, time)` at every key.
template <typename Position>
TriangleMesh make_mesh(std::string name, std::uint32_t vertices, std::uint32_t segments,
                       std::vector<Triangle> triangles, const Position& position) {
  TriangleMesh mesh;
  mesh.name = std::move(name);
  mesh.segments = segments;
  mesh.vertex_count = vertices;
  mesh.triangles = std::move(triangles);
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    const float time = segments == 0 ? 0.5f : static_cast<float>(key) / static_cast<float>(segments);
    for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(position(v, time));
  }
  return mesh;
}

std::vector<Triangle> separate_triangles(std::uint32_t count) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return triangles;
}

}  // namespace

TriangleMesh make_soup(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed) {
  struct Body {
    Vec3f center, travel, axis, corner[3];
    float turn;
  };
  Random random(seed);
  const float size = 0.7f / std::cbrt(static_cast<float>(triangles));
  std::vector<Body> bodies(triangles);
  for (Body& body : bodies) {
    body.center = random.in_cube(0.5f);
    body.travel = random.in_cube(2.0f * size);
    body.axis = unit(random.in_cube(1.0f));
    body.turn = random.in(-kPi, kPi);
    for (Vec3f& corner : body.corner) corner = random.in_cube(size);
  }
  return make_mesh(
      "soup", 3 * triangles, segments, separate_triangles(triangles), [&](std::uint32_t v, float time) {
        const Body& body = bodies[v / 3];
        return body.center + body.travel * time + turned(body.corner[v % 3], body.axis, body.turn * time);
      });
}

TriangleMesh make_hair(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed) {
  struct Strand {
    Vec3f root, along, across, axis;
    float swing;
  };
  Random random(seed);
  std::vector<Strand> strands(triangles);
  for (Strand& strand : strands) {
    const Vec3f out = unit(random.in_cube(1.0f));
    strand.root = out * 0.2f;
    strand.along = unit(out + random.in_cube(0.5f)) * random.in(0.2f, 0.35f);
    strand.across = unit(cross(strand.along, random.in_cube(1.0f))) * 0.0015f;
    strand.axis = unit(random.in_cube(1.0f));
    strand.swing = random.in(0.1f, 0.5f);
  }
  return make_mesh(
      "hair", 3 * triangles, segments, separate_triangles(triangles), [&](std::uint32_t v, float time) {
        const Strand& strand = strands[v / 3];
        const Vec3f tip = v % 3 == 2 ? strand.along : strand.across * (v % 3 == 0 ? -1.0f : 1.0f);
        return strand.root + turned(tip, strand.axis, strand.swing * time);
      });
}

TriangleMesh make_sphere(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed) {
  Random random(seed);
  const Vec3f phase = random.in_cube(kPi);
  const auto rows = static_cast<std::uint32_t>(std::sqrt(static_cast<float>(triangles) / 4.0f));
  const std::uint32_t columns = 2 * rows;
  std::vector<Triangle> faces;
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = r * columns + c, b = r * columns + (c + 1) % columns;
      faces.push_back({a, b, a + columns});
      faces.push_back({b, b + columns, a + columns});
    }
  }
  return make_mesh(
      "sphere", (rows + 1) * columns, segments, std::move(faces), [&](std::uint32_t v, float time) {
        const float theta = kPi * static_cast<float>(v / columns) / static_cast<float>(rows);
        const float phi = 2.0f * kPi * static_cast<float>(v % columns) / static_cast<float>(columns);
        const Vec3f out{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
        const float wrinkle = std::sin(9.0f * phi + phase.x) * std::sin(11.0f * theta + phase.y);
        const Vec3f rolled = turned(out * (0.4f + 0.01f * wrinkle), {0.0f, 0.0f, 1.0f}, -1.2f * time);
        return rolled + Vec3f{0.48f * time - 0.24f, 0.0f, 0.0f};
      });
}

}  // namespace msbvh::bench
