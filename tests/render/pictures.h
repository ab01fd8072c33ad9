// Small scenes and the means to compare their pictures with closed forms. One world unit is one pixel: the
// camera is orthographic, looks along -z, and its window is [0, width] x [0, height], with y up.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/api/renderer.h"

namespace msbvh::pictures {

constexpr float kPi = std::numbers::pi_v<float>;

inline Affine3f translation(const Vec3f& t) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t}; }

inline Camera pixel_camera(std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.projection = Projection::kOrthographic;
  camera.world_from_camera = {translation({0, 0, 100})};
  camera.window = {{0.0f, float(width), 0.0f, float(height)}};
  camera.near_clip = 0.0f;
  return camera;
}

// A convex polygon as a fan; `keys` holds its corners at each key of its track.
inline Mesh polygon(const std::vector<std::vector<Vec3f>>& keys) {
  Mesh mesh;
  mesh.shape.name = "/polygon";
  mesh.shape.segments = static_cast<std::uint32_t>(keys.size()) - 1;
  mesh.shape.vertex_count = static_cast<std::uint32_t>(keys[0].size());
  for (const auto& key : keys) {
    mesh.shape.positions.insert(mesh.shape.positions.end(), key.begin(), key.end());
  }
  for (std::uint32_t i = 2; i < mesh.shape.vertex_count; ++i) mesh.shape.triangles.push_back({0, i - 1, i});
  return mesh;
}

inline std::vector<Vec3f> rectangle(float x0, float y0, float x1, float y1, float z = 0.0f) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

// The cube [-1, 1]^3, still.
inline Mesh cube() {
  Mesh mesh;
  mesh.shape.name = "/cube";
  mesh.shape.vertex_count = 8;
  for (int i = 0; i < 8; ++i) {
    mesh.shape.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  }
  for (const auto& quad : {std::array<std::uint32_t, 4>{0, 1, 3, 2},
                           {4, 5, 7, 6},
                           {0, 1, 5, 4},
                           {2, 3, 7, 6},
                           {0, 2, 6, 4},
                           {1, 3, 7, 5}}) {
    mesh.shape.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.shape.triangles.push_back({quad[0], quad[2], quad[3]});
  }
  return mesh;
}

// The mesh under a transform at each key, into its own vertices.
inline Mesh baked(Mesh mesh, const std::vector<Affine3f>& keys) {
  const std::vector<Vec3f> still(mesh.shape.positions.begin(),
                                 mesh.shape.positions.begin() + mesh.shape.vertex_count);
  mesh.shape.segments = static_cast<std::uint32_t>(keys.size()) - 1;
  mesh.shape.positions.clear();
  for (const Affine3f& m : keys) {
    for (const Vec3f& p : still) mesh.shape.positions.push_back(m.point(p));
  }
  return mesh;
}

// Returns its index.
inline std::uint32_t add_mesh(Scene& scene, Mesh mesh) {
  mesh.shape = validated(std::move(mesh.shape));
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

inline void add(Scene& scene, Mesh mesh) { scene.world.push_back(mesh_id(add_mesh(scene, std::move(mesh)))); }

// The mesh as the one instance of a prototype of its own.
inline void add_instance(Scene& scene, Mesh mesh, const std::vector<Affine3f>& keys) {
  const auto prototype = static_cast<std::uint32_t>(scene.prototypes.size());
  scene.prototypes.push_back({"/prototype", {mesh_id(add_mesh(scene, std::move(mesh)))}});
  scene.instances.push_back({"/instance", prototype, static_cast<std::uint32_t>(keys.size()) - 1, keys, {}});
}

inline Light camera_light() {
  Light light;
  light.name = "/cameraLight";
  light.kind = LightKind::kCamera;
  return light;
}

inline Light dome(const Vec3f& radiance) {
  Light light;
  light.name = "/dome";
  light.kind = LightKind::kDome;
  light.radiance = radiance;
  return light;
}

inline Image render(const Scene& scene, const RenderSettings& settings) {
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(scene), settings);
  return renderer.render();
}

constexpr int kAlpha = 3;
inline float channel(const Image& image, std::uint32_t x, std::uint32_t y, int c) {
  return image.rgba[4 * (std::size_t(y) * image.width + x) + c];
}

// Mean and standard deviation of the mean of independent estimates.
class Estimates {
 public:
  void add(double value) {
    ++count_;
    const double step = value - mean_;
    mean_ += step / count_;
    squares_ += step * (value - mean_);
  }
  double mean() const { return mean_; }
  double sigma() const { return std::sqrt(squares_ / (count_ - 1) / count_); }

  // Within 5 standard deviations. `error` is what is known of the error of `expected`, and of single
  // precision.
  void check(double expected, double error) const {
    CAPTURE(mean_);
    CAPTURE(expected);
    CAPTURE(sigma());
    CHECK(std::abs(mean_ - expected) <= 5.0 * sigma() + error);
  }

 private:
  int count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

constexpr double kSinglePrecision = 1e-6;  // of a mean of numbers of about 1

// Compares alpha with a closed form of the column: the rows of a column are independent estimates of it.
inline void check_columns(const Image& image, const std::function<double(std::uint32_t)>& expected) {
  for (std::uint32_t x = 0; x < image.width; ++x) {
    Estimates column;
    for (std::uint32_t y = 0; y < image.height; ++y) column.add(channel(image, x, y, kAlpha));
    CAPTURE(x);
    column.check(expected(x), kSinglePrecision);
  }
}

// Mean over the shutter of the share of pixel [x, x + 1] that lies left of an edge that moves evenly from e0
// to e1.
inline double swept(double x, double e0, double e1) {
  const auto integral = [](double z) { return z <= 0 ? 0.0 : z <= 1 ? z * z / 2 : z - 0.5; };
  return (integral(e1 - x) - integral(e0 - x)) / (e1 - e0);
}

}  // namespace msbvh::pictures
