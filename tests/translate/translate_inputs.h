// Inputs for the translator's tests: small meshes, transforms and a camera, with the arrays they borrow kept
// alive.
#pragma once

#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate::testing {

inline Matrix4d row_vector_matrix(const Affine3d& a) {
  return {a.x.x, a.x.y, a.x.z, 0, a.y.x, a.y.y, a.y.z, 0, a.z.x, a.z.y, a.z.z, 0, a.t.x, a.t.y, a.t.z, 1};
}

inline Affine3d translation(const Vec3d& t) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t}; }

// About the z axis.
inline Affine3d rotation(double degrees) {
  const double a = degrees * std::numbers::pi / 180.0;
  return {{std::cos(a), std::sin(a), 0}, {-std::sin(a), std::cos(a), 0}, {0, 0, 1}, {}};
}

using Motion = std::function<Affine3d(double time01)>;

inline TransformSamples sampled(const Motion& motion, const std::vector<double>& times01) {
  TransformSamples samples{times01, {}};
  for (const double time01 : times01) samples.matrices.push_back(row_vector_matrix(motion(time01)));
  return samples;
}

inline TransformSamples still(const Affine3d& map = {}) { return {{0.0}, {row_vector_matrix(map)}}; }

inline std::vector<double> uniform_times(int intervals) {
  std::vector<double> times01;
  for (int i = 0; i <= intervals; ++i) times01.push_back(double(i) / intervals);
  return times01;
}

// A camera at `eye` that looks along -z, 90 degrees across a square image: at distance d, `width` pixels show
// 2 d.
inline CameraInput camera_at(const Vec3d& eye) {
  CameraInput camera;
  camera.path = "/camera";
  camera.near_clip = 0.1f;
  camera.samples.push_back({0.0, row_vector_matrix(translation(eye)), ScreenWindow{}});
  return camera;
}

inline TranslatorSettings settings_of(std::uint32_t width = 1000) {
  TranslatorSettings settings;
  settings.width = settings.height = width;
  return settings;
}

// Chords only, as the baselines have it.
inline TranslatorSettings linear_settings(std::uint32_t width = 1000) {
  TranslatorSettings settings = settings_of(width);
  settings.choice.max_degree = 1;
  return settings;
}

// Instances that share their sample times: [T][count] matrices.
inline InstancesInput instances_of(std::string path, std::uint32_t prototype, std::vector<double> times01,
                                   std::span<const Matrix4d> matrices, std::span<const Vec3f> colors = {}) {
  InstancesInput input{std::move(path), prototype, {}, {}, {}};
  input.display_color.values = colors;
  input.levels.push_back({std::move(times01), matrices, {}, false, nullptr, {}});
  return input;
}

// A mesh and what it borrows: a unit quad in the plane z = 0 until changed.
struct MeshFixture {
  std::string path = "/mesh";
  std::vector<int> counts{4};
  std::vector<int> indices{0, 1, 2, 3};
  std::vector<int> holes;
  bool left_handed = false;
  std::vector<double> times01{0.0};
  std::deque<std::vector<Vec3f>> points{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  bool held = false;
  double frame01 = 0.5;
  TransformSamples transform = still();

  MeshInput input() const {
    MeshInput mesh;
    mesh.path = path;
    mesh.face_vertex_counts = counts;
    mesh.face_vertex_indices = indices;
    mesh.hole_indices = holes;
    mesh.left_handed = left_handed;
    for (std::size_t i = 0; i < points.size(); ++i) mesh.points.samples.push_back({times01[i], points[i]});
    mesh.points.held = held;
    mesh.time_remap.frame01 = frame01;
    mesh.world_from_object = transform;
    return mesh;
  }
  void add_points(double time01, std::vector<Vec3f> values) {
    times01.push_back(time01);
    points.push_back(std::move(values));
  }
};

inline std::size_t count(const Translator& translator, Severity severity, const std::string& attribute) {
  std::size_t n = 0;
  for (const Diagnostic& d : translator.diagnostics())
    n += d.severity == severity && d.attribute == attribute;
  return n;
}

}  // namespace msbvh::translate::testing
