// Implicit shapes as polygons. Shapes are built along z around the origin, then turned so that z becomes the
// authored axis. Vertices lie on the shape. Edges that are to stay sharp have two sets of vertices, so that
// smooth normals do not run across them.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/shape/implicit_type.h"

namespace msbvh::translate {

// A polygon mesh.
struct Surface {
  std::vector<int> counts;    // vertices a face
  std::vector<int> indices;   // counter-clockwise seen from outside
  std::vector<Vec3d> points;  // in the shape's own space
};

// `values` are the type's parameters, in its order: any finite numbers. `sides` around the axis, at least 4:
// half as many from pole to pole of a sphere, a quarter over each cap of a capsule; cubes and planes have
// none. The topology depends on the kind and the sides alone, and points are linear in every value, so that
// the values' samples are the points'.
Surface implicit_surface(ImplicitKind kind, std::span<const double> values, Axis axis, int sides);

// From along z to along `axis`, by a cyclic exchange of the axes, which keeps the orientation.
Vec3d turned(const Vec3d& point, Axis axis);

// The values as they lie along z: a plane's width lies along x, or along z where x is its axis, and its
// length along y, or along z where y is its axis. In the cycle, that exchanges them wherever z is not the
// axis.
std::vector<double> values_along_z(ImplicitKind kind, std::span<const double> values, Axis axis);

}  // namespace msbvh::translate
