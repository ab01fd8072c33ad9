#include "delegate/translate/shape/crowd.h"

#include <algorithm>
#include <cstdint>

#include "core/base/affine.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/shape/surface.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

bool is_length(double value) { return 0.0 <= value && value <= kLargestElement; }  // false for NaN too

// A form in which only ratios count, scaled evenly by `size`.
UnitForm in_ratio(std::span<const double> values, double size) {
  UnitForm form{{}, {size, size, size}, Axis::kZ};
  for (const double value : values) form.parameters.push_back(value / size);
  return form;
}

// Infinite or NaN where a size is 0 that others are divided by.
UnitForm form_along_z(ImplicitKind kind, std::span<const double> v) {
  switch (kind) {
    case ImplicitKind::kSphere:
    case ImplicitKind::kCube:
      return {{1.0}, {v[0], v[0], v[0]}, Axis::kZ};
    case ImplicitKind::kCone:
    case ImplicitKind::kCylinder:
      return {{1.0, 1.0}, {v[0], v[0], v[1]}, Axis::kZ};
    case ImplicitKind::kCylinder1: {
      const double largest = std::max(v[0], v[1]);
      return {{v[0] / largest, v[1] / largest, 1.0}, {largest, largest, v[2]}, Axis::kZ};
    }
    case ImplicitKind::kCapsule:
      return in_ratio(v, v[0]);
    case ImplicitKind::kCapsule1:
      return in_ratio(v, std::max(v[0], v[1]));
    case ImplicitKind::kPlane:
      return {{1.0, 1.0}, {v[0], v[1], 1.0}, Axis::kZ};
  }
  return {};
}

// The same side outside at every time, and never flat.
class Course {
 public:
  void add(const Matrix4d& m) {
    const Affine3d map = affine_from(m);
    const bool affine = m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] == 1.0;
    if (!affine || !is_representable(map) || is_singular(map)) {
      sound_ = false;
    } else {
      (map.determinant() > 0.0 ? upright_ : mirrored_) = true;
    }
  }
  bool sound() const { return sound_ && !(upright_ && mirrored_); }

 private:
  bool sound_ = true, upright_ = false, mirrored_ = false;
};

}  // namespace

std::optional<UnitForm> unit_form(ImplicitKind kind, std::span<const double> values, Axis axis) {
  if (!std::ranges::all_of(values, is_length)) return std::nullopt;
  UnitForm form = form_along_z(kind, values_along_z(kind, values, axis));
  if (!(std::min({form.scale.x, form.scale.y, form.scale.z}) > 0.0)) return std::nullopt;
  if (!std::ranges::all_of(form.parameters, is_length)) return std::nullopt;
  form.axis = axis;
  return form;
}

Matrix4d shape_from_unit(const UnitForm& form) {
  const Vec3d rows[] = {turned({form.scale.x, 0.0, 0.0}, form.axis),
                        turned({0.0, form.scale.y, 0.0}, form.axis),
                        turned({0.0, 0.0, form.scale.z}, form.axis)};
  Matrix4d matrix{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[std::size_t(4 * row + column)] = rows[row][column];
  }
  matrix[15] = 1.0;
  return matrix;
}

std::vector<bool> can_be_instances(std::span<const Matrix4d> matrices, std::size_t count,
                                   std::span<const Vec3f> colors, std::optional<float> opacity) {
  std::vector<Course> courses(count);
  for (std::size_t i = 0; i < matrices.size(); ++i) courses[i % count].add(matrices[i]);
  std::vector<bool> result(count, !opacity || is_color(*opacity));
  for (std::size_t i = 0; i < count; ++i) {
    result[i] = result[i] && courses[i].sound() && (colors.empty() || is_color(colors[i]));
  }
  return result;
}

}  // namespace msbvh::translate
