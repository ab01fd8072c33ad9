// What many implicit prims may have in common: a sphere is the unit sphere scaled by its radius, a cylinder
// the unit cylinder scaled by radius and height, and so on. Shapes of one unit form can be instances of one
// mesh.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/shape/implicit_type.h"

namespace msbvh::translate {

// Shapes that are alike; fewer are meshes of their own, which rays find without a way through instances.
inline constexpr std::size_t kSharedFrom = 16;
// Of a group whose shapes are placed one by one, in each of its places. Where it stands more often, its
// shapes are meshes: a mesh of a few hundred triangles takes less than so many instances of it.
inline constexpr std::size_t kMostPlaces = 64;

struct UnitForm {
  std::vector<double> parameters;  // of the unit shape, which stands along z
  Vec3d scale;                     // along the unit shape's axes, each larger than 0
  Axis axis;                       // along which the z of the scaled shape lies
};

// None for a shape that stands for itself: one with a value that is negative, larger than 2^60 or no number,
// one that is flat, or so thin a needle that its unit shape would be longer than 2^60.
std::optional<UnitForm> unit_form(ImplicitKind kind, std::span<const double> values, Axis axis);

// What makes the shape of the unit shape.
Matrix4d shape_from_unit(const UnitForm& form);

// Which of `count` shapes can be instances: those whose matrices [time][count] from the unit shape are
// affine, of usable size and never flat, not even between two times, and whose colours (one each, or none
// given) and opacity (of all) are usable (is_color).
std::vector<bool> can_be_instances(std::span<const Matrix4d> matrices, std::size_t count,
                                   std::span<const Vec3f> colors, std::optional<float> opacity);

}  // namespace msbvh::translate
