#include "delegate/translate/shape/implicit_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "delegate/translate/sample/sampler.h"

namespace msbvh::translate {
namespace {

// In six digits: printf's own, without the sign of what is no number.
std::string text_of(double value) {
  if (std::isnan(value)) return "nan";
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

bool check_parameters(ImplicitKind kind, std::span<const double> values, PrimLog& log) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) <= kLargestElement) continue;
    return log.reject(
        std::string(implicit_type(kind).parameters[i]),
        message("found ", text_of(values[i]), ", expected a finite number of at most 2^60 in size"));
  }
  return true;
}

std::optional<ImplicitShape> ImplicitShape::make(ImplicitInput input, PrimLog& log) {
  for (const std::vector<double>& values : input.values) {
    if (!check_parameters(input.kind, values, log)) return std::nullopt;
  }
  const std::optional<Axis> axis = axis_from(input.axis);
  if (!axis) log.warn("axis", message("found '", input.axis, "', expected X, Y or Z; took Z"));
  return ImplicitShape(input.kind, axis.value_or(Axis::kZ), std::move(input.values));
}

double ImplicitShape::radius() const {
  double largest = 0.0;
  for (const std::vector<double>& values : values_)
    largest = std::max(largest, largest_radius(kind_, values));
  return largest;
}

Box3d ImplicitShape::box(int sides) const {
  Box3d box;
  for (std::size_t time = 0; time < values_.size(); ++time) {
    for (const Vec3d& point : surface(time, sides).points) box.grow(point);
  }
  return box;
}

Surface ImplicitShape::surface(std::size_t time, int sides) const {
  return implicit_surface(kind_, values_[time], axis_, sides);
}

}  // namespace msbvh::translate
