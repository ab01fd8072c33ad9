// Prototypes and their instances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/vec.h"
#include "core/geometry/geometry_id.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"
#include "core/scene/material.h"

namespace msbvh {

// Geometry that is instanced together; it lives in the prototype's own space, and in its own time.
struct Prototype {
  std::string name;
  std::vector<GeometryId> geometry;  // as in Scene::world, in its order
  TimeRemap time_remap{};            // from the shutter's time to that of the geometry's tracks
};

struct InstancePrimvar {
  PrimvarName name = kNoPrimvar;
  std::vector<Vec3f> values;  // of one to three numbers, the rest 0
};

// Instances of one prototype whose transforms are tracks of one form under one time remap.
struct InstanceSet {
  std::string name;
  std::uint32_t prototype = 0;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_prototype;  // [instance][form().controls()], instance-major
  // Empty, or one an instance at each of key_count(color_segments) keys, key-major, in the shutter's time:
  // overrides the meshes' own.
  std::vector<Vec3f> display_color;
  std::uint32_t degree = 1;
  TimeRemap time_remap{};  // of the transforms; hides all of the set where it says so
  std::uint32_t color_segments = 0;
  // Still, one value an instance, or none: override the meshes' own.
  std::vector<float> display_opacity{};
  std::vector<InstancePrimvar> primvars{};  // each name once
  std::vector<std::uint32_t> materials{};   // empty, or one an instance: overrides the meshes' own
  // For AOVs: each one's number in its instancer, -1 for what is no instance; empty: its place in the set.
  std::vector<std::int32_t> ids{};
  std::vector<std::uint32_t> light_groups{};  // empty, or one an instance: overrides the meshes' own

  TrackForm form() const { return {segments, degree}; }
};

inline std::size_t instance_count(const InstanceSet& set) {
  return set.world_from_prototype.size() / set.form().controls();
}

}  // namespace msbvh
