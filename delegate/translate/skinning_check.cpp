#include <algorithm>
#include <cmath>

#include "delegate/translate/skinning.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr const char* kPoints = "points";
constexpr const char* kIndices = "primvars:skel:jointIndices";
constexpr const char* kWeights = "primvars:skel:jointWeights";
constexpr const char* kGeomBind = "primvars:skel:geomBindTransform";
constexpr const char* kSkeleton = "skel:skeleton";
constexpr const char* kNormals = "normals";

bool check_finite(std::span<const Vec3f> values, const std::string& attribute, PrimLog& log) {
  const auto bad = std::ranges::find_if(values, [](Vec3f v) { return !is_finite(v); });
  if (bad == values.end()) return true;
  return log.reject(attribute, message("value ", bad - values.begin(), " is (", bad->x, ", ", bad->y, ", ",
                                       bad->z, "); expected finite numbers"));
}

bool check_point_indices(std::span<const int> indices, std::size_t point_count, const std::string& attribute,
                         PrimLog& log) {
  const auto bad =
      std::ranges::find_if(indices, [&](int i) { return i < 0 || std::size_t(i) >= point_count; });
  if (bad == indices.end()) return true;
  return log.reject(attribute, message("index ", bad - indices.begin(), " is ", *bad,
                                       "; expected a point from 0 to ", std::ptrdiff_t(point_count) - 1));
}

bool check_counts(const SkinningInput& input, PrimLog& log) {
  const std::size_t found = input.joint_indices.size();
  if (found != input.joint_weights.size()) {
    return log.reject(kWeights, message("found ", input.joint_weights.size(), " weights; expected ", found,
                                        ", as many as ", kIndices));
  }
  if (input.influences_per_point < 1) {
    return log.reject(kIndices,
                      message("found elementSize ", input.influences_per_point, "; expected at least 1"));
  }
  const std::size_t influences = std::size_t(input.influences_per_point);
  if (found % influences != 0) {
    return log.reject(kIndices,
                      message("found ", found, " values; expected a multiple of elementSize ", influences));
  }
  const std::size_t expected = input.constant_influences ? influences : influences * input.points.size();
  if (found == expected) return true;
  return log.reject(kIndices, message("found ", found, " values; expected ", expected, ", ", influences,
                                      input.constant_influences ? " for the mesh" : " for each point"));
}

bool check_influences(const SkinningInput& input, PrimLog& log) {
  if (!check_counts(input, log)) return false;
  const auto index = std::ranges::find_if(
      input.joint_indices, [&](int i) { return i < 0 || std::size_t(i) >= input.joint_count; });
  if (index != input.joint_indices.end()) {
    return log.reject(kIndices,
                      message("value ", index - input.joint_indices.begin(), " is ", *index,
                              "; expected a joint from 0 to ", std::ptrdiff_t(input.joint_count) - 1));
  }
  const auto weight = std::ranges::find_if(input.joint_weights, [](float w) { return !std::isfinite(w); });
  if (weight == input.joint_weights.end()) return true;
  return log.reject(kWeights, message("value ", weight - input.joint_weights.begin(), " is ", *weight,
                                      "; expected finite numbers"));
}

bool check_joints(const SkinningInput& input, PrimLog& log) {
  const std::size_t expected = input.times01.size() * input.joint_count;
  if (input.joints.size() != expected) {
    return log.reject(kSkeleton, message("found ", input.joints.size(), " joint transforms; expected ",
                                         expected, ", one a joint and time"));
  }
  const auto bad =
      std::ranges::find_if(input.joints, [](const Matrix4d& m) { return !is_representable(affine_from(m)); });
  if (bad == input.joints.end()) return true;
  const std::size_t at = std::size_t(bad - input.joints.begin());
  return log.reject(kSkeleton,
                    message("the transform of joint ", at % input.joint_count, " ",
                            at_shutter_time(input.times01[at / input.joint_count]),
                            " is not a number or too large; expected finite joint and bind transforms"));
}

bool check_sub_shape_weights(const SkinningInput& input, PrimLog& log) {
  const std::size_t expected = input.times01.size() * input.sub_shapes.size();
  if (input.sub_shape_weights.size() != expected) {
    return log.reject("skel:blendShapes", message("found ", input.sub_shape_weights.size(),
                                                  " weights; expected ", expected, ", one a shape and time"));
  }
  const auto bad = std::ranges::find_if(input.sub_shape_weights, [](float w) { return !std::isfinite(w); });
  if (bad == input.sub_shape_weights.end()) return true;
  const std::size_t at = std::size_t(bad - input.sub_shape_weights.begin());
  return log.reject("skel:blendShapes",
                    message("the weight of ", input.sub_shapes[at % input.sub_shapes.size()].path, " ",
                            at_shutter_time(input.times01[at / input.sub_shapes.size()]), " is ", *bad,
                            "; expected a finite number"));
}

bool check_offsets(std::span<const Vec3f> offsets, const char* name, const SubShape& shape,
                   std::size_t point_count, PrimLog& log) {
  if (offsets.empty()) return true;
  const bool indexed = !shape.point_indices.empty();
  const std::size_t expected = indexed ? shape.point_indices.size() : point_count;
  if (offsets.size() == expected) return check_finite(offsets, name, log);
  return log.reject(name, message("found ", offsets.size(), " offsets; expected ", expected,
                                  indexed ? ", as many as pointIndices" : ", one a point"));
}

}  // namespace

bool check_sub_shape(const SubShape& shape, std::size_t point_count, PrimLog& log) {
  return check_point_indices(shape.point_indices, point_count, "pointIndices", log) &&
         check_offsets(shape.offsets, "offsets", shape, point_count, log) &&
         check_offsets(shape.normal_offsets, "normalOffsets", shape, point_count, log);
}

bool check_rest_normals(const SkinningInput& input, PrimLog& log) {
  const bool mapped = !input.normal_points.empty();
  const std::size_t expected = mapped ? input.normal_points.size() : input.points.size();
  if (input.normals.size() != expected) {
    return log.reject(kNormals, message("found ", input.normals.size(), " values; expected ", expected,
                                        mapped ? ", one a face-vertex" : ", one a point"));
  }
  return check_finite(input.normals, kNormals, log) &&
         check_point_indices(input.normal_points, input.points.size(), "faceVertexIndices", log);
}

bool check_skinning(const SkinningInput& input, PrimLog& log) {
  if (!check_times(input.times01, kSkeleton, log) || !check_finite(input.points, kPoints, log)) return false;
  if (!input.sub_shapes.empty() && !check_sub_shape_weights(input, log)) return false;
  if (input.joint_indices.empty() && input.joint_weights.empty()) return true;
  if (!check_influences(input, log) || !check_joints(input, log)) return false;
  if (is_representable(affine_from(input.geom_bind))) return true;
  return log.reject(kGeomBind, "is not a number or too large; expected a finite matrix");
}

}  // namespace msbvh::translate
