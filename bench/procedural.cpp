#include "bench/procedural.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/motion/bezier_fit.h"

namespace msbvh::procedural {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

TriangleMesh still(std::string name, std::vector<Vec3f> positions, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  mesh.name = std::move(name);
  mesh.vertex_count = static_cast<std::uint32_t>(positions.size());
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return validated(std::move(mesh));
}

void add_quad(std::vector<Triangle>& out, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d) {
  out.push_back({a, b, c});
  out.push_back({a, c, d});
}

}  // namespace

std::uint32_t Random::next() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005ull + 1442695040888963407ull;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
  const auto turn = static_cast<std::uint32_t>(old >> 59u);
  return (shifted >> turn) | (shifted << ((32u - turn) & 31u));
}

Vec3f Random::in_box(const Vec3f& lo, const Vec3f& hi) {
  const float x = uniform(lo.x, hi.x), y = uniform(lo.y, hi.y), z = uniform(lo.z, hi.z);
  return {x, y, z};
}

Vec3f Random::direction() {
  const float z = uniform(-1.0f, 1.0f), phi = uniform() * float(kTwoPi);
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Motion translation(const Vec3d& over_shutter) {
  return [=](const Vec3d& p, double u) { return p + over_shutter * (u - 0.5); };
}

Motion rotation(const Vec3d& axis, double radians_over_shutter, const Vec3d& pivot) {
  const Vec3d k = normalize(axis);
  return [=](const Vec3d& p, double u) {
    const double a = radians_over_shutter * (u - 0.5);
    const Vec3d v = p - pivot;
    return pivot + v * std::cos(a) + cross(k, v) * std::sin(a) + k * (dot(k, v) * (1.0 - std::cos(a)));
  };
}

Motion wave(double amplitude, double wave_length) {
  return [=](const Vec3d& p, double u) {
    return p + Vec3d{0.0, amplitude * std::sin(kTwoPi * (p.x / wave_length + u)),
                     0.3 * amplitude * std::cos(kTwoPi * (p.z / wave_length - u))};
  };
}

TriangleMesh moved(TriangleMesh mesh, const TrackForm& form, const Motion& motion, const Vec3d& offset) {
  const std::vector<Vec3f> centre(mesh.positions.begin(), mesh.positions.begin() + mesh.vertex_count);
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  mesh.positions.assign(mesh.position_count(), {});
  const auto nodes = fit_nodes(form.degree);
  for (std::size_t v = 0; v < centre.size(); ++v) {
    const auto at = [&](double u) { return motion(Vec3d(centre[v]), u) + offset; };
    if (!form.moving()) mesh.positions[v] = Vec3f(at(0.5));
    for (std::uint32_t k = 0; k < form.segments; ++k) {
      Vec3d values[kMaxDegree + 1];
      for (std::uint32_t i = 0; i <= form.degree; ++i) values[i] = at((k + nodes[i]) / form.segments);
      controls_from_values([&](std::uint32_t i) -> Vec3d& { return values[i]; }, form.degree);
      for (std::uint32_t i = 0; i <= form.degree; ++i) {
        mesh.positions[std::size_t(k * form.degree + i) * mesh.vertex_count + v] = Vec3f(values[i]);
      }
    }
  }
  return validated(std::move(mesh));
}

TriangleMesh moved(TriangleMesh mesh, std::uint32_t segments, const Motion& motion, const Vec3d& offset) {
  return moved(std::move(mesh), TrackForm{segments, 1}, motion, offset);
}

TriangleMesh sphere(int rings) {
  const int columns = 2 * rings;
  std::vector<Vec3f> p{{0, 0, 1}};
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = kTwoPi * j / columns;
      p.push_back(
          Vec3f(Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}));
    }
  }
  p.push_back({0, 0, -1});
  const auto at = [&](int ring, int column) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * columns + column % columns);
  };
  const auto south = static_cast<std::uint32_t>(p.size() - 1);
  std::vector<Triangle> t;
  for (int j = 0; j < columns; ++j) t.push_back({0, at(1, j), at(1, j + 1)});
  for (int i = 1; i + 1 < rings; ++i) {
    for (int j = 0; j < columns; ++j) add_quad(t, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  for (int j = 0; j < columns; ++j) t.push_back({south, at(rings - 1, j + 1), at(rings - 1, j)});
  return still("sphere", std::move(p), std::move(t));
}

TriangleMesh grid(int side) {
  std::vector<Vec3f> p;
  std::vector<Triangle> t;
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j)
      p.push_back({4.0f * float(i) / float(side) - 2.0f, 0.0f, 4.0f * float(j) / float(side) - 2.0f});
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (side + 1) + j); };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) add_quad(t, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  }
  return still("grid", std::move(p), std::move(t));
}

TriangleMesh sticks(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> p;
  std::vector<Triangle> t;
  for (int i = 0; i < count; ++i) {
    const Vec3f a = random.in_box({-2, -2, -2}, {2, 2, 2});
    const Vec3f axis = normalize(random.direction() + Vec3f{1.5f, 1.0f, 0.5f});
    const Vec3f x = normalize(cross(axis, random.direction())), y = cross(axis, x);
    const auto first = static_cast<std::uint32_t>(p.size());
    for (const float along : {0.0f, random.uniform(1.0f, 3.0f)}) {
      for (int corner = 0; corner < 3; ++corner) {
        const float angle = float(kTwoPi) * float(corner) / 3.0f;
        p.push_back(a + axis * along + (x * std::cos(angle) + y * std::sin(angle)) * 0.01f);
      }
    }
    for (std::uint32_t c = 0; c < 3; ++c)
      add_quad(t, first + c, first + (c + 1) % 3, first + 3 + (c + 1) % 3, first + 3 + c);
  }
  return still("sticks", std::move(p), std::move(t));
}

TriangleMesh soup(int count, float size, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> p;
  std::vector<Triangle> t;
  for (int i = 0; i < count; ++i) {
    const Vec3f centre = random.in_box({-2, -2, -2}, {2, 2, 2});
    const auto first = static_cast<std::uint32_t>(p.size());
    for (int v = 0; v < 3; ++v) p.push_back(centre + random.direction() * size);
    t.push_back({first, first + 1, first + 2});
  }
  return still("soup", std::move(p), std::move(t));
}

TriangleMesh debris(int count, std::uint32_t segments, float speed, std::uint64_t seed) {
  TriangleMesh mesh = soup(count, 0.08f, seed);
  mesh.name = "debris";
  Random random(seed + 1);
  std::vector<Vec3d> velocity;
  for (int i = 0; i < count; ++i) velocity.push_back(Vec3d(random.direction() * (speed * random.uniform())));
  const std::vector<Vec3f> centre(mesh.positions.begin(), mesh.positions.begin() + mesh.vertex_count);
  mesh.segments = segments;
  mesh.positions.clear();
  for (std::uint32_t k = 0; k < key_count(segments); ++k) {
    const double u = segments == 0 ? 0.5 : double(k) / segments;
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
      const Motion spin = rotation(velocity[v / 3], 2.0 * speed, Vec3d(centre[v / 3 * 3]));
      mesh.positions.push_back(Vec3f(spin(Vec3d(centre[v]), u) + velocity[v / 3] * (u - 0.5)));
    }
  }
  return validated(std::move(mesh));
}

TriangleMesh wheel(int spokes, int rings) {
  std::vector<Vec3f> p;
  std::vector<Triangle> t;
  const auto bar = [&](const Vec3f& a, const Vec3f& b, const Vec3f& side) {
    const auto first = static_cast<std::uint32_t>(p.size());
    for (const Vec3f& end : {a, b}) {
      p.push_back(end + side);
      p.push_back(end + Vec3f{0, 0, 0.02f});
      p.push_back(end - side);
    }
    for (std::uint32_t c = 0; c < 3; ++c)
      add_quad(t, first + c, first + (c + 1) % 3, first + 3 + (c + 1) % 3, first + 3 + c);
  };
  const auto on_rim = [](double turn) {
    return Vec3f(Vec3d{2.0 * std::cos(kTwoPi * turn), 2.0 * std::sin(kTwoPi * turn), 0.0});
  };
  for (int i = 0; i < spokes; ++i) {
    const Vec3f end = on_rim(double(i) / spokes);
    bar({}, end, normalize(cross(end, Vec3f{0, 0, 1})) * 0.02f);
  }
  for (int i = 0; i < rings; ++i) {
    const Vec3f a = on_rim(double(i) / rings);
    bar(a, on_rim(double(i + 1) / rings), normalize(a) * 0.05f);
  }
  return still("wheel", std::move(p), std::move(t));
}

Ray random_ray(Random& random, const Vec3f& centre, float radius) {
  Ray ray;
  ray.org = centre + random.direction() * (radius * random.uniform(0.1f, 1.5f));
  const Vec3f target = centre + random.direction() * (radius * random.uniform() * 0.8f);
  ray.dir = target - ray.org;
  ray.time = random.uniform();
  return ray;
}

}  // namespace msbvh::procedural
