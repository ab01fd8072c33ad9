// The immutable snapshot of one frame that the renderer draws: plain data, no pointers into anyone else's.
//
// Space: "world" here is the frame's world, the stage's world minus the frame's origin (a point near the
// camera, kept in double by the front-end), so that single precision serves scenes at any distance from the
// stage's origin. Time: every track spans the open shutter, see core/motion/track.h. Colour: linear, in the
// working space (Rec.709 primaries); radiance without a photometric unit.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/vec.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/clock.h"

namespace msbvh {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The number of values a primvar has on a triangle mesh. USD's `uniform` is expanded to one value a triangle
// and `varying` equals `vertex` on meshes.
enum class Interpolation : std::uint8_t {
  kConstant,    // 1
  kTriangle,    // one a triangle
  kVertex,      // one a vertex
  kFaceVarying  // three a triangle, in the order of its vertices
};

template <typename T>
struct Primvar {
  Interpolation interpolation = Interpolation::kConstant;
  std::uint32_t segments = 0;  // values are [key_count(segments)][count], key-major
  std::vector<T> values;       // empty: not authored
  bool authored() const { return !values.empty(); }
};

// Values of a primvar at one key.
std::size_t value_count(Interpolation interpolation, const TriangleMesh& shape);

struct Mesh {
  TriangleMesh shape;  // with its guard: accelerators share it as it stands
  // Shading normals, need not be unit length; not authored: the triangle's own. In the mesh's time; the other
  // primvars are in the shutter's.
  Primvar<Vec3f> normals;
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  // Empty, or one a triangle in place of `material`: parts with materials of their own stay one mesh, with
  // one tree and no edges that could leak.
  std::vector<std::uint32_t> triangle_materials{};
  // For AOVs: the prim's id, kNone for the mesh's index, and the face that each triangle is of; empty: each
  // is one.
  std::uint32_t prim_id = kNone;
  std::vector<std::uint32_t> triangle_faces{};
};

// The constants of a UsdPreviewSurface that the diffuse model uses.
struct Material {
  std::string name{};
  Vec3f diffuse_color{0.18f, 0.18f, 0.18f};
  bool diffuse_from_display_color = false;  // diffuseColor is connected to a reader of primvars:displayColor
  Vec3f emissive_color{};
  bool emissive_from_display_color = false;  // likewise of emissiveColor
  float opacity = 1.0f;
  bool opacity_from_display_opacity = false;
  float opacity_threshold = 0.0f;  // > 0: opacity below it counts as 0, else as 1 (UsdPreviewSurface)
};

// Meshes that are instanced together; they live in the prototype's own space, and in its own time.
struct Prototype {
  std::string name;
  std::vector<std::uint32_t> meshes;  // indices into Scene::meshes
  Clock clock{};                      // from the shutter's time to that of the meshes' tracks
};

// Instances of one prototype whose transforms are tracks of one form under one clock.
struct InstanceSet {
  std::string name;
  std::uint32_t prototype = 0;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_prototype;  // [instance][form().controls()], instance-major
  // Empty, or one an instance at each of key_count(color_segments) keys, key-major, in the shutter's time:
  // overrides the meshes' own.
  std::vector<Vec3f> display_color;
  std::uint32_t degree = 1;
  Clock clock{};  // of the transforms; hides all of the set where it says so
  std::uint32_t color_segments = 0;
  std::vector<std::uint32_t> materials{};  // empty, or one an instance: overrides the meshes' own

  TrackForm form() const { return {segments, degree}; }
};

inline std::size_t instance_count(const InstanceSet& set) {
  return set.world_from_prototype.size() / set.form().controls();
}

enum class LightKind : std::uint8_t {
  kDistant,  // shines along -z of its space from a disc of `angle_degrees` across
  kDome,     // constant, from everywhere
  kSphere,   // `radius`, at the origin of its space; radius 0: a point
  kRect,     // `width` x `height` in the xy plane of its space, shines along -z
  kCamera    // usdrecord's camera light: at the camera, unit irradiance times pi at any distance, casts no
             // shadow
};

// What a light gives, and how large it is.
struct LightValues {
  // Radiance leaving the light (distant: see normalize in UsdLux; intensity, exposure, colour and
  // normalisation are already multiplied in by the front-end). Point lights (radius 0): radiant intensity.
  Vec3f radiance{1.0f, 1.0f, 1.0f};
  float angle_degrees = 0.53f;
  float radius = 0.5f;
  float width = 1.0f;
  float height = 1.0f;
  bool operator==(const LightValues&) const = default;
};

struct Light : LightValues {  // its values while nothing but the transform moves
  std::string name;
  LightKind kind = LightKind::kDistant;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_light;  // key_count(segments)
  // Empty, or key_count(segments): taken instead. A radius or angle that is 0 at one key is so at all of
  // them.
  std::vector<LightValues> moving_values;
};

// The part of the image plane that the image shows, at unit distance from the eye for a perspective camera,
// in scene units for an orthographic one. left < right, bottom < top, unless the camera mirrors.
struct ScreenWindow {
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
};

constexpr ScreenWindow lerp(const ScreenWindow& a, const ScreenWindow& b, float w) {
  return {lerp(a.left, b.left, w), lerp(a.right, b.right, w), lerp(a.bottom, b.bottom, w),
          lerp(a.top, b.top, w)};
}

// A thin lens at the eye, across the camera's z axis, in camera space.
struct Lens {
  float radius = 0.0f;          // of its aperture, a disc
  float focus_distance = 1.0f;  // along -z, of the plane in focus
};

constexpr Lens lerp(const Lens& a, const Lens& b, float w) {
  return {lerp(a.radius, b.radius, w), lerp(a.focus_distance, b.focus_distance, w)};
}

// Distances along -z between which camera rays see.
struct ClipRange {
  float near_clip = 1.0f, far_clip = 1.0e6f;
};

constexpr ClipRange lerp(const ClipRange& a, const ClipRange& b, float w) {
  return {lerp(a.near_clip, b.near_clip, w), lerp(a.far_clip, b.far_clip, w)};
}

enum class Projection : std::uint8_t { kPerspective, kOrthographic };

// Looks along -z with y up, as USD cameras do.
struct Camera {
  std::string name;
  Projection projection = Projection::kPerspective;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_camera;  // form().controls(), rigid or not
  std::vector<ScreenWindow> window;         // form().controls()
  std::vector<Lens> lens;                   // empty: a pinhole; else form().controls(), perspective only
  float near_clip = 1.0f;  // distances along -z; what lies outside is not seen by camera rays
  float far_clip = 1.0e6f;
  std::uint32_t degree = 1;
  Clock clock{};                  // of the tracks; hides nothing
  std::vector<ClipRange> clip{};  // empty: near_clip to far_clip throughout; else form().controls()

  TrackForm form() const { return {segments, degree}; }
};

struct Scene {
  std::vector<Mesh> meshes;
  std::vector<std::uint32_t> world_meshes;  // indices of the meshes that stand in the world directly
  std::vector<Prototype> prototypes;
  std::vector<InstanceSet> instances;
  std::vector<Material> materials;
  std::vector<Light> lights;
  Camera camera;
};

// The gate of the whole scene: the meshes (core/geometry's gate), primvar sizes, indices, track lengths,
// finite matrices, light and camera parameters. Changes nothing; throws Error naming the part, found and
// expected.
void validate(const Scene& scene);

}  // namespace msbvh
