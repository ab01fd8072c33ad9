#include "delegate/translate/shape/implicit_type.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

using Names = const std::string_view[];

constexpr Names kRadius = {"radius"};
constexpr Names kSize = {"size"};
constexpr Names kRadiusAndHeight = {"radius", "height"};
constexpr Names kRadiiAndHeight = {"radiusBottom", "radiusTop", "height"};
constexpr Names kWidthAndLength = {"width", "length"};

constexpr ImplicitType kTypes[] = {
    {"Sphere", kRadius, true},
    {"Cube", kSize, false},
    {"Cone", kRadiusAndHeight, true},
    {"Cylinder", kRadiusAndHeight, true},
    {"Cylinder_1", kRadiiAndHeight, true},
    {"Capsule", kRadiusAndHeight, true},
    {"Capsule_1", kRadiiAndHeight, true},
    {"Plane", kWidthAndLength, false},
};

}  // namespace

std::span<const ImplicitType> implicit_types() { return kTypes; }

std::optional<ImplicitKind> implicit_kind(std::string_view name) {
  const auto found = std::ranges::find(kTypes, name, &ImplicitType::name);
  if (found == std::end(kTypes)) return std::nullopt;
  return ImplicitKind(found - std::begin(kTypes));
}

std::optional<Axis> axis_from(std::string_view token) {
  if (token == "X") return Axis::kX;
  if (token == "Y") return Axis::kY;
  if (token == "Z") return Axis::kZ;
  return std::nullopt;
}

double largest_radius(ImplicitKind kind, std::span<const double> values) {
  const std::span<const std::string_view> names = implicit_type(kind).parameters;
  double largest = 0.0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].starts_with("radius")) largest = std::max(largest, std::abs(values[i]));
  }
  return largest;
}

}  // namespace msbvh::translate
