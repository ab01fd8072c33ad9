// What a front-end (the command line, the Hydra plugin) has read from a stage, as plain structs. Nothing here
// depends on USD or Python. Spans borrow: they must live until the call that takes them returns.
//
// Times are `time01`: (time code - shutter open) / (shutter close - shutter open). 0 is the shutter's
// opening, 1 its closing; samples that bracket the shutter lie outside [0, 1] and are wanted. With a closed
// shutter, one sample at 0. Matrices are double, in USD's row-vector convention (p' = p * M, translation in
// the last row), row-major.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/scene/scene.h"

namespace msbvh::translate {

using Matrix4d = std::array<double, 16>;

// A transform at increasing times, to be interpolated linearly by element between them and held outside. The
// front-end evaluates the stage at as many times as that takes. One sample: still.
struct TransformSamples {
  std::vector<double> times01;
  std::vector<Matrix4d> matrices;
};

// One authored sample of points (or normals).
struct ArraySample {
  double time01 = 0.0;
  std::span<const Vec3f> values;
};

// Samples at increasing times, interpolated linearly between them (`held`: each holds until the next), held
// outside.
struct ArraySamples {
  std::vector<ArraySample> samples;
  bool held = false;
};

template <typename T>
struct PrimvarSample {
  double time01 = 0.0;
  std::span<const T> values;
};

template <typename T>
struct PrimvarInput {
  std::string interpolation = "constant";  // USD's token: constant, uniform, varying, vertex, faceVarying
  std::span<const T> values;               // at the frame; empty: not authored
  std::span<const int> indices;            // at the frame; empty: not indexed
  // At increasing times, linear between them; two within kJumpTime01 (value_track.h) make a jump. None:
  // still.
  std::vector<PrimvarSample<T>> samples{};
};

enum class Normals : std::uint8_t { kFaceted, kSmooth };  // what to compute where none are authored

struct MeshInput {
  std::string path;  // of the prim, for messages
  std::span<const int> face_vertex_counts;
  std::span<const int> face_vertex_indices;
  std::span<const int> hole_indices;
  bool left_handed = false;
  ArraySamples points;
  TransformSamples world_from_object;  // stage space; for a prototype's mesh: prototype_from_object
  ArraySamples normals;                // no samples: not authored
  std::string normals_interpolation = "vertex";
  std::span<const int> normals_indices;
  Normals computed_normals = Normals::kFaceted;
  PrimvarInput<Vec3f> display_color;
  PrimvarInput<float> display_opacity;
  std::uint32_t material = kNone;
};

struct InstancesInput {
  std::string path;
  std::uint32_t prototype = 0;
  std::vector<double> times01;           // T increasing times, shared by all instances
  std::span<const Matrix4d> matrices;    // [T][count], time-major: stage space from prototype space
  std::span<const Vec3f> display_color;  // empty, or one an instance
};

// One time of a camera; window and lens as in core/scene/scene.h.
struct CameraSample {
  double time01 = 0.0;
  Matrix4d world_from_camera{};
  ScreenWindow window;
  Lens lens{};  // radius 0: a pinhole, and so it must be for an orthographic camera
};

struct CameraInput {
  std::string path;
  Projection projection = Projection::kPerspective;
  std::vector<CameraSample> samples;  // increasing times, dense enough to be interpolated linearly
  float near_clip = 1.0f;
  float far_clip = 1.0e6f;
};

struct LightInput {
  Light light;  // name, kind, and its values where none are sampled
  TransformSamples world_from_light;
  // Values at increasing times, linear between them; two within kJumpTime01 (value_track.h) make a jump.
  // None: still. A radius or angle that is 0 in one sample must be so in all.
  std::vector<double> values_times01;
  std::vector<LightValues> values;
};

}  // namespace msbvh::translate
