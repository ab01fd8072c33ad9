// A triangle in the world at one time, and how far from it the tracer may see it.
#pragma once

#include <cstdint>

#include "core/base/affine.h"
#include "core/geometry/triangle_mesh.h"
#include "core/shade/scene_index.h"

namespace msbvh {

// How the meshes of a hit's source stand in the world at one time.
struct ObjectPose {
  Affine3d world_from_object;
  Affine3d size;            // by element, the largest at the controls around the time
  double error = 0.0;       // relative to the sizes of the terms of a point's way out of the instance
  bool instanced = false;   // else in the world itself: nothing of the above is used

  ObjectPose(const HitSource& source, float shutter_time);
};

struct WorldTriangle {
  Vec3d vertex[3];
  // By axis: a bound on how far any point of the triangle is from where the tracer sees it, for a ray that starts
  // about as near as the triangle is large. The rounding of that origin is included.
  Vec3d margin;
};

WorldTriangle world_triangle(const HitSource& source, const ObjectPose& pose, std::uint32_t triangle,
                             float shutter_time);

}  // namespace msbvh
