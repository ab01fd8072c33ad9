// UsdGeom's implicit prims: which types there are, and what their attributes are called.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace msbvh::translate {

enum class ImplicitKind : std::uint8_t {
  kSphere,
  kCube,
  kCone,
  kCylinder,
  kCylinder1,
  kCapsule,
  kCapsule1,
  kPlane
};

struct ImplicitType {
  std::string_view name;                         // of the prim type
  std::span<const std::string_view> parameters;  // attributes, in the order in which values are given
  bool smooth;                                   // normals are; else faceted
};

// In the order of ImplicitKind.
std::span<const ImplicitType> implicit_types();
inline const ImplicitType& implicit_type(ImplicitKind kind) { return implicit_types()[std::size_t(kind)]; }
// Of a prim type's name; none for other prims.
std::optional<ImplicitKind> implicit_kind(std::string_view name);

// Along which the z of a shape lies. Cubes and spheres have no such attribute: z.
enum class Axis : std::uint8_t { kX, kY, kZ };

std::optional<Axis> axis_from(std::string_view token);

// The largest radius around the axis; 0 where there is none. `values` are as many as the type's parameters.
double largest_radius(ImplicitKind kind, std::span<const double> values);

}  // namespace msbvh::translate
