// All of a frame as a front-end has looked it up: values with their times, and motions that can be asked for
// more. What is made of it is decided in assemble.h. Spans borrow: they must live until assemble_frame()
// returns.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/frame/intervals.h"
#include "delegate/translate/frame/motions.h"
#include "delegate/translate/frame/placed_levels.h"
#include "delegate/translate/frame/shutter.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/light_groups.h"
#include "delegate/translate/look/light_samples.h"
#include "delegate/translate/look/shader_network.h"
#include "delegate/translate/shape/implicit_shape.h"
#include "delegate/translate/shape/subsets.h"

namespace msbvh::translate {

// Integers over the shutter, each sample held until the next and the first one before it too. Fewer than two:
// the frame's hold throughout.
struct HeldIndices {
  std::vector<std::pair<double, std::span<const int>>> samples{};  // at increasing time01
};

// What of a primvar is held.
struct HeldPrimvar {
  HeldIndices indices{};
  bool values = false;  // each sample until the next, as on a held stage
};

// What of a shape is held and changes within the shutter. Where values are given here, those in the shape are
// the frame's.
struct HeldShapeValues {
  HeldIndices holes{}, normals_indices{};
  HeldPrimvar display_color{}, display_opacity{};
};

// Faces that have a material of their own.
struct BoundSubset {
  FaceSubset faces;
  std::string material{};  // path of the material; empty: none
  HeldIndices held{};      // of the faces
};

// An implicit prim's parameters: those of the frame, then those at `times01`, which increase.
struct ImplicitFrameInput {
  ImplicitInput shape;
  std::vector<double> times01{};
  bool held = false;  // each until the next
};

// A mesh, curves, points or an implicit prim, without its transform.
struct FrameShape {
  // Without world_from_object, material, face_materials. `named_primvars` may be more than its materials
  // read.
  MeshInput mesh;
  MotionPointer motion{};  // one thing: into the world or its group's space
  std::string material{};  // path; empty: displayColor shows
  std::vector<BoundSubset> subsets{};
  HeldShapeValues held{};
  std::optional<ImplicitFrameInput> implicit{};  // in place of the mesh's topology and points
};

// Shapes that are placed together.
struct FrameGroup {
  std::string path{};  // of the prim that instances them; empty: they stand in the world
  std::vector<FrameShape> shapes{};
  std::vector<PlacedLevel> levels{};    // the innermost first; none: they stand in the world
  Visibility visible{};                 // of the levels
  PrimvarInput<Vec3f> display_color{};  // one an instance, without indices, or none

  std::size_t count() const;  // of instances; 1 in the world
};

struct FrameLight {
  std::string path{};
  LightKind kind = LightKind::kDistant;
  SampledLight light;
  MotionPointer motion;  // one thing a place
  LightLook look{};
  std::optional<Matrix4d> offset{};  // comes before the motion: a dome's turn to its pole
};

// A material of which a network was found.
struct FrameMaterial {
  std::string path{};
  ShaderNetwork network;
};

struct FrameInput {
  CameraInput camera;
  Shutter shutter;  // of the camera
  std::vector<FrameMaterial> materials{};
  std::vector<FrameGroup> groups{};
  std::vector<FrameLight> lights{};
  LightGroups light_groups{};
  bool camera_light = true;  // usdrecord's, where there is no light
};

}  // namespace msbvh::translate
