// Where the surface of a NURBS patch is bent, closed or drawn together.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/vec.h"
#include "delegate/translate/shape/nurbs_patch.h"

namespace msbvh::translate {

// One pose of a patch, seen along one of its directions.
struct PatchSide {
  const NurbsPatch& patch;
  std::span<const Vec3f> pose;
  std::span<const double> weights;
  bool along_u;

  const SplineAxis& axis() const { return along_u ? patch.u() : patch.v(); }
  const SplineAxis& across() const { return along_u ? patch.v() : patch.u(); }
};

// Distances below this share of the patch's size are none.
inline constexpr double kSamePlace = 1e-6;
// Radians: normals that differ by less are smoothed.
inline constexpr double kKinkAngle = 0.01;

// Whether normals differ between the end of a span and the beginning of another one, which lie in one place.
bool is_kinked(const PatchSide& side, const SplineSpan& before, const SplineSpan& after);
// Whether the surface ends where it begins.
bool is_closed(const PatchSide& side);
// Whether all points are one where it begins (or ends).
bool is_pole(const PatchSide& side, bool at_end);

}  // namespace msbvh::translate
