// What a front-end (the command line, the Hydra plugin) has read from a stage, as plain structs. Nothing here
// depends on USD or Python. Spans borrow: they must live until the call that takes them returns.
//
// Times are `time01`: (time code - shutter open) / (shutter close - shutter open). 0 is the shutter's
// opening, 1 its closing; samples that bracket the shutter, or the frame, lie outside [0, 1] and are wanted.
// With a closed shutter, one sample at 0. A prim with a blur scale has a shutter of its own, scaled about the
// frame (UsdGeomMotionAPI). Matrices are double, in USD's row-vector convention (p' = p * M, translation in
// the last row), row-major.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/scene/scene.h"
#include "delegate/translate/round/curve_basis.h"

namespace msbvh::translate {

using Matrix4d = std::array<double, 16>;

// A transform at increasing times, to be interpolated by element between them and held outside; with `held`,
// each holds until the next. The front-end evaluates the stage at as many times as that takes, and at eight a
// turn at least, so that no motion hides between two of them. One sample: still.
struct TransformSamples {
  std::vector<double> times01;
  std::vector<Matrix4d> matrices;
  // Breakpoints of the motion: authored times. The other samples lie evenly on smooth curves between them
  // (smooth_times.h). None given: anywhere, and lines between samples.
  std::optional<std::vector<double>> breakpoints01{};
  bool held = false;
  double error_pixels = 0.0;  // by which interpolation of the samples may stray from the stage
  // After which the motion may repeat, as shares of the shutter: what a rotation at a constant rate suggests.
  std::vector<double> periods01{};
};

// One authored sample of points (or normals).
struct ArraySample {
  double time01 = 0.0;
  std::span<const Vec3f> values;
};

// Samples at increasing times, interpolated linearly between them (`held`: each holds until the next), held
// outside. Their sizes may differ, as far as rules allow.
struct ArraySamples {
  std::vector<ArraySample> samples;
  bool held = false;
  // Not time samples but one value, authored for all times: no rates apply to it (USD's rule).
  bool timeless = false;

  bool empty() const { return samples.empty(); }
};

// Rates of change beside an array. Whether they count is decided here (rates.h), not by the front-end.
struct RateInput {
  ArraySamples velocities;     // per second; angular ones in degrees per second, about their direction
  ArraySamples accelerations;  // per second squared
};

// What turns rates into positions at a time.
struct RateTimes {
  double frame01 = 0.0;            // where the frame lies: the base sample is the one at or before it
  double seconds_per_shutter = 0;  // the shutter's length in seconds, by timeCodesPerSecond
  float velocity_scale = 1.0f;     // motion:velocityScale: multiplies velocities
};

// Instants [begin, end) of the shutter at which something is visible (held, as USD says).
struct VisibleInterval {
  double begin01, end01;
};

template <typename T>
struct PrimvarSample {
  double time01 = 0.0;
  std::span<const T> values;
};

// How far a value may stray from the samples, where values lie between 0 and 1: a step of 8 bits. Of larger
// values it is that share of the largest.
inline constexpr double kPrimvarTolerance = 1.0 / 256.0;

template <typename T>
struct PrimvarInput {
  std::string interpolation = "constant";  // USD's token: constant, uniform, varying, vertex, faceVarying
  std::span<const T> values;               // at the frame; empty: not authored
  std::span<const int> indices;            // at the frame; empty: not indexed
  // At increasing times, linear between them; two within kJumpTime01 (value_track.h) make a jump. None:
  // still.
  std::vector<PrimvarSample<T>> samples{};
  double tolerance = kPrimvarTolerance;
};

// A primvar that materials read by its name: one to three numbers, the rest 0.
struct NamedPrimvar {
  std::string name;  // without primvars:
  PrimvarInput<Vec3f> primvar;
};
inline std::string full_name(const NamedPrimvar& named) { return "primvars:" + named.name; }

enum class Normals : std::uint8_t { kFaceted, kSmooth };  // what to compute where none are authored

// How a mesh is subdivided, in UsdGeomMesh's tokens.
struct SubdivisionInput {
  std::string scheme = "none";  // none: polygons
  std::string interpolate_boundary = "edgeAndCorner";
  std::string face_varying_linear = "cornersPlus1";
  std::string triangle_rule = "catmullClark";
  std::span<const int> crease_lengths, crease_indices;
  std::span<const float> crease_sharpnesses;  // one a crease, or one an edge
  std::span<const int> corner_indices;
  std::span<const float> corner_sharpnesses;
};

// What a point-based prim is that has no faces: curves, or points, with a width.
struct RoundInput {
  enum class Kind : std::uint8_t { kNone, kCurves, kPoints };

  Kind kind = Kind::kNone;  // a mesh
  CurveTopology topology;   // of curves
  PrimvarInput<float>
      widths;  // diameters, in the prim's space; of curves `varying` unless they say otherwise
};

// What curves are drawn as.
enum class CurveStyle : std::uint8_t {
  kRibbon,  // flat: across their normals where they have some, else turned to each ray
  kTube     // round, whatever their normals say
};

// Of curves: 1, and they scatter light as hair does.
inline constexpr std::string_view kFibrePrimvar = "msbvh:fibre";

// Of a mesh or, by `round`, of curves or points, which have no faces.
struct MeshInput {
  std::string path;  // of the prim, for messages
  std::span<const int> face_vertex_counts;
  std::span<const int> face_vertex_indices;
  std::string indices_name = "faceVertexIndices";  // of the attribute, for messages
  std::span<const int> hole_indices;
  bool left_handed = false;
  SubdivisionInput subdivision{};
  RoundInput round{};
  ArraySamples points;
  RateInput rates;
  RateTimes time_remap;
  bool topology_varies = false;  // faces change within the shutter
  bool computed_points = false;  // not authored: skinned, or of an implicit shape
  // How far its faces lie off the surface that they stand for, at most, in its own space: what an implicit
  // shape's sides leave. NaN: not known.
  double stray = 0.0;
  std::optional<std::vector<VisibleInterval>> visible;  // not given: always
  TransformSamples world_from_object;  // stage space; for a prototype's mesh: prototype_from_object
  ArraySamples normals;                // no samples: not authored
  std::string normals_interpolation = "vertex";
  std::span<const int> normals_indices;
  Normals computed_normals = Normals::kFaceted;
  PrimvarInput<Vec3f> display_color;
  PrimvarInput<float> display_opacity;
  // That its materials read, displacement included; others may be among them.
  std::vector<NamedPrimvar> named_primvars{};  // kFibrePrimvar among them, where curves have it
  bool displaced = true;                       // by its materials, where they say so
  std::uint32_t material = kNone;
  // Empty, or one a face in place of `material`; negative: none.
  std::span<const int> face_materials;
  std::uint32_t prim_id = kNone;  // for the AOV primId; kNone: the place in the scene
};

// Quaternions as USD lays them out.
struct Quatf {
  float i, j, k, real;
};
struct QuaternionSample {
  double time01 = 0.0;
  std::span<const Quatf> values;
};
struct QuaternionSamples {
  std::vector<QuaternionSample> samples;  // increasing times
  bool held = false, timeless = false;
};

// The arrays of a UsdGeomPointInstancer.
struct PointInstancerInput {
  std::string path;       // of the instancer, which need not be the innermost; empty: the instances' own
  std::size_t count = 0;  // of protoIndices at the frame
  ArraySamples positions, scales;
  QuaternionSamples orientations;
  std::string orientations_name = "orientations";  // or orientationsf, for messages
  RateInput rates;
  ArraySamples angular_velocities;  // degrees per second
  RateTimes time_remap;
};

// A level of instancing: maps that stand side by side. Either matrices or a point instancer's arrays.
struct InstanceLevel {
  std::vector<double> times01;         // T increasing times
  std::span<const Matrix4d> matrices;  // [T][count], time-major
  std::optional<std::vector<double>> breakpoints01{};
  bool held = false;

  const PointInstancerInput* points = nullptr;
  std::span<const int> selected;    // the instances of the arrays that count, by index; `points` only
  std::vector<double> periods01{};  // as of TransformSamples; matrices only
};

struct InstancesInput {
  std::string path;
  std::uint32_t prototype = 0;
  // From the prototype's space outwards to the stage's. There are as many instances as the product of the
  // levels' counts, those of the outermost level varying slowest.
  std::vector<InstanceLevel> levels;
  std::optional<std::vector<VisibleInterval>> visible;  // not given: always
  PrimvarInput<Vec3f> display_color;                    // one an instance, without indices, or none
  std::span<const float> display_opacity{};             // one an instance, or none
  // One an instance, without samples and indices; of those that no material reads nothing is kept.
  std::vector<NamedPrimvar> primvars{};
  // Empty, or one an instance in place of the prototype's own; negative: none.
  std::span<const int> materials{};
  // Of the prims that the innermost level's maps place, one each: every prim has a track report of its own.
  // Empty: the instances are one prim's, or many that move alike.
  std::vector<std::string> paths{};
  // Whether there is a report of all together as well; always, where there are no paths.
  bool report_whole = false;
  // For the AOV instanceId, one an instance; empty: they are counted.
  std::span<const std::int32_t> ids{};
};

// One time of a camera; window, lens and clip as in core/scene/scene.h.
struct CameraSample {
  double time01 = 0.0;
  Matrix4d world_from_camera{};
  ScreenWindow window;
  Lens lens{};                      // radius 0: a pinhole, and so it must be for an orthographic camera
  std::optional<ClipRange> clip{};  // in all samples or in none: from the camera's near_clip to its far_clip
};

struct CameraInput {
  std::string path;
  Projection projection = Projection::kPerspective;
  std::vector<CameraSample> samples;  // increasing times, as dense as TransformSamples
  // Breakpoints of the motion: authored times. The other samples lie on smooth curves. None given: anywhere.
  std::optional<std::vector<double>> breakpoints01{};
  std::vector<double> periods01{};  // as of TransformSamples
  float near_clip = 1.0f;           // the nearest and the farthest of all samples
  float far_clip = 1.0e6f;
  std::vector<ClippingPlane> clipping_planes{};  // those of checked_planes() (frame/clipping_planes.h)
};

// What a mesh light's material and its light have to do with each other (UsdLuxLightAPI's materialSyncMode).
enum class MaterialSync : std::uint8_t {
  kGlowTintsLight,  // the light's colour is multiplied by the material's constant glow, where it has one
  kIndependent,
  kNoMaterial  // the mesh is black and glows as the light does
};

struct MeshSurface {
  std::string path{};  // of the prim whose triangles shine
  MaterialSync sync = MaterialSync::kGlowTintsLight;
  bool normalize = false;  // by the area in the world, which the front-end does not know
};

struct PortalInput {
  TransformSamples world_from_portal;
  float width = 1.0f, height = 1.0f;
};

struct LightInput {
  Light light;  // name, kind, and its values where none are sampled
  TransformSamples world_from_light;
  // Values at increasing times, linear between them; two within kJumpTime01 (value_track.h) make a jump.
  // None: still. A radius or angle that is 0 in one sample must be so in all.
  std::vector<double> values_times01;
  std::vector<LightValues> values;
  MeshSurface surface{};               // kMesh
  std::vector<PortalInput> portals{};  // kDome
};

}  // namespace msbvh::translate
