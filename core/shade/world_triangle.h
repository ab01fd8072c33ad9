// A triangle in the world at one time, and how far from it the tracer may see it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/affine.h"
#include "core/geometry/triangle_mesh.h"
#include "core/shade/scene_index.h"

namespace msbvh {

// How an instance stands in the world at one time. For sources in the world itself there is none.
struct InstancePose {
  Affine3d world_from_object;
  // By axis, at all controls around the time: how far a corner of the cube [-1, 1]^3 in the object can be
  // from the instance's origin, and that from the world's.
  Vec3f reach, place;
  float error;  // relative to the sizes of the terms of a point's way out of the instance

  InstancePose(const HitSource& source, float shutter_time);
};

template <EffectSet kEffects = kKnownEffects>
std::optional<InstancePose> instance_pose(const HitSource& source, float shutter_time) {
  if constexpr (!kEffects.has(Effect::kInstances)) return std::nullopt;
  return source.instances ? std::optional<InstancePose>(std::in_place, source, shutter_time) : std::nullopt;
}

struct WorldTriangle {
  Vec3d vertex[3];
  // A bound on how far any point of the triangle is from where the tracer sees it, for a ray that starts
  // about as near as the triangle is large. The rounding of that origin is included.
  double margin;
};

// Of a mesh or of grids. kEffects: kPlain or kKnownEffects.
template <EffectSet kEffects = kKnownEffects>
WorldTriangle world_triangle(const HitSource& source, const std::optional<InstancePose>& pose,
                             std::uint32_t triangle, float shutter_time);

}  // namespace msbvh
