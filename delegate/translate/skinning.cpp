#include "delegate/translate/skinning.h"

#include <algorithm>

#include "core/base/affine.h"
#include "core/base/parallel.h"
#include "delegate/translate/rigid.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr std::size_t kGrain = 1024;  // points at a time for one thread
constexpr double kNoStretch = 1e-6;   // UsdSkel: joints that stretch by less are rigid

// What moves one normal: the inverse transpose. Singular: nothing is left of a normal.
Affine3d normal_map(const Affine3d& map) {
  const double determinant = map.determinant();
  const double s = determinant == 0.0 ? 0.0 : 1.0 / determinant;
  return {cross(map.y, map.z) * s, cross(map.z, map.x) * s, cross(map.x, map.y) * s, {}};
}

// The influences of a point, whether its own or the mesh's.
class Influences {
 public:
  explicit Influences(const SkinningInput& input)
      : indices_(input.joint_indices.data()),
        weights_(input.joint_weights.data()),
        count_(std::size_t(input.influences_per_point)),
        stride_(input.constant_influences ? 0 : count_) {}

  // body(joint, weight) for each weight that is not zero.
  template <typename Body>
  void each(std::size_t point, const Body& body) const {
    for (std::size_t i = point * stride_; i < point * stride_ + count_; ++i) {
      if (weights_[i] != 0.0f) body(std::size_t(indices_[i]), double(weights_[i]));
    }
  }
  // The first joint among those of the largest weight.
  std::size_t strongest(std::size_t point) const {
    const float* begin = weights_ + point * stride_;
    return std::size_t(
        indices_[point * stride_ + std::size_t(std::max_element(begin, begin + count_) - begin)]);
  }

 private:
  const int* indices_;
  const float* weights_;
  std::size_t count_, stride_;
};

// Linear blending at one time.
class LinearPose {
 public:
  LinearPose(const SkinningInput& input, std::span<const Matrix4d> joints) : influences_(input) {
    const Affine3d bind = affine_from(input.geom_bind);
    const Affine3d normal_bind = normal_map(bind);
    for (const Matrix4d& joint : joints) {
      const Affine3d map = affine_from(joint);
      maps_.push_back(map * bind);
      normal_maps_.push_back(normal_map(map) * normal_bind);
    }
  }

  Vec3d point(std::size_t i, const Vec3d& rest) const {
    Vec3d sum;
    influences_.each(i, [&](std::size_t joint, double w) { sum += maps_[joint].point(rest) * w; });
    return sum;
  }
  Vec3d normal(std::size_t i, const Vec3d& rest) const {
    Vec3d sum;
    influences_.each(i, [&](std::size_t joint, double w) { sum += normal_maps_[joint].vector(rest) * w; });
    return sum;
  }

 private:
  Influences influences_;
  std::vector<Affine3d> maps_, normal_maps_;
};

// Dual quaternions at one time.
class RigidPose {
 public:
  RigidPose(const SkinningInput& input, std::span<const Matrix4d> joints)
      : influences_(input), bind_(affine_from(input.geom_bind)), normal_bind_(normal_map(bind_)) {
    for (const Matrix4d& matrix : joints) add_joint(affine_from(matrix));
  }

  Vec3d point(std::size_t i, const Vec3d& rest) const {
    return blended(i).point(stretched(i, bind_.point(rest), &Joint::stretch));
  }
  Vec3d normal(std::size_t i, const Vec3d& rest) const {
    return blended(i).vector(stretched(i, normal_bind_.vector(rest), &Joint::normal_stretch));
  }

 private:
  struct Joint {
    DualQuaternion motion;  // zero: singular, moves nothing
    Affine3d stretch, normal_stretch;
  };

  void add_joint(const Affine3d& map) {
    Joint joint;
    if (const std::optional<PolarParts> parts = polar_parts(map)) {
      joint.motion = rigid_motion(rotation_of(parts->rotation), map.t);
      joint.stretch = parts->stretch;
      joint.normal_stretch = normal_map(parts->stretch);
      const Affine3d& s = joint.stretch;
      for (const Vec3d& d : {s.x - Vec3d(1, 0, 0), s.y - Vec3d(0, 1, 0), s.z - Vec3d(0, 0, 1)}) {
        const Vec3d size = abs(d);
        stretches_ = stretches_ || std::max({size.x, size.y, size.z}) >= kNoStretch;
      }
    }
    joints_.push_back(joint);
  }

  // As weights are not normalised, whether any joint of the mesh stretches decides if they scale the point.
  Vec3d stretched(std::size_t i, const Vec3d& rest, Affine3d Joint::*stretch) const {
    if (!stretches_) return rest;
    Vec3d sum;
    influences_.each(i,
                     [&](std::size_t joint, double w) { sum += (joints_[joint].*stretch).vector(rest) * w; });
    return sum;
  }

  // q and -q are the same rotation: each joint takes the one on the side of the strongest.
  Affine3d blended(std::size_t i) const {
    const Quaternion& pivot = joints_[influences_.strongest(i)].motion.real;
    DualQuaternion sum;
    influences_.each(i, [&](std::size_t joint, double w) {
      const DualQuaternion& motion = joints_[joint].motion;
      sum += motion * (dot(motion.real, pivot) < 0.0 ? -w : w);
    });
    return rigid_map(sum);
  }

  Influences influences_;
  Affine3d bind_, normal_bind_;
  std::vector<Joint> joints_;
  bool stretches_ = false;
};

// Rest values with the blend shapes of one time.
struct Rest {
  std::vector<Vec3d> points, normals;
};

std::vector<Vec3d> widened(std::span<const Vec3f> values) {
  std::vector<Vec3d> result;
  result.reserve(values.size());
  for (const Vec3f& value : values) result.emplace_back(value);
  return result;
}

void add_offsets(std::span<const Vec3f> offsets, std::span<const int> indices, double weight,
                 std::vector<Vec3d>& sums) {
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    sums[indices.empty() ? i : std::size_t(indices[i])] += Vec3d(offsets[i]) * weight;
  }
}

Rest blended_rest(const SkinningInput& input, std::size_t time) {
  Rest rest{widened(input.points), widened(input.normals)};
  std::vector<Vec3d> normal_offsets;
  for (std::size_t s = 0; s < input.sub_shapes.size(); ++s) {
    const SubShape& shape = input.sub_shapes[s];
    const double weight = input.sub_shape_weights[time * input.sub_shapes.size() + s];
    if (weight == 0.0) continue;
    add_offsets(shape.offsets, shape.point_indices, weight, rest.points);
    if (input.normals.empty() || shape.normal_offsets.empty()) continue;
    normal_offsets.resize(input.points.size());
    add_offsets(shape.normal_offsets, shape.point_indices, weight, normal_offsets);
  }
  if (normal_offsets.empty()) return rest;
  for (std::size_t i = 0; i < rest.normals.size(); ++i) {
    const std::size_t point = input.normal_points.empty() ? i : std::size_t(input.normal_points[i]);
    rest.normals[i] = normalize(rest.normals[i] + normal_offsets[point]);
  }
  return rest;
}

template <typename Body>
std::vector<Vec3f> each_in_parallel(std::size_t count, const Body& body) {
  std::vector<Vec3f> result(count);
  parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = Vec3f(body(i));
  });
  return result;
}

template <typename Pose>
void add_posed(const SkinningInput& input, const Rest& rest, const Pose& pose, SkinnedArrays& result) {
  result.points.push_back(
      each_in_parallel(rest.points.size(), [&](std::size_t i) { return pose.point(i, rest.points[i]); }));
  if (rest.normals.empty()) return;
  result.normals.push_back(each_in_parallel(rest.normals.size(), [&](std::size_t i) {
    const std::size_t point = input.normal_points.empty() ? i : std::size_t(input.normal_points[i]);
    return normalize(pose.normal(point, rest.normals[i]));
  }));
}

// Blend shapes alone.
struct RestPose {
  Vec3d point(std::size_t, const Vec3d& rest) const { return rest; }
  Vec3d normal(std::size_t, const Vec3d& rest) const { return rest; }
};

// The input without the blend shapes and normals that do not fit.
SkinningInput usable(const SkinningInput& input, PrimLog& log, std::vector<float>& weights) {
  PrimLog optional = log.of_optional_part();
  SkinningInput result = input;
  if (!input.normals.empty() && !check_rest_normals(input, optional)) result.normals = {};
  std::vector<std::size_t> kept;
  for (std::size_t s = 0; s < input.sub_shapes.size(); ++s) {
    PrimLog shape_log = log.of_part(input.sub_shapes[s].path);
    if (check_sub_shape(input.sub_shapes[s], input.points.size(), shape_log)) kept.push_back(s);
  }
  if (kept.size() == input.sub_shapes.size()) return result;
  result.sub_shapes.clear();
  for (const std::size_t s : kept) result.sub_shapes.push_back(input.sub_shapes[s]);
  for (std::size_t t = 0; t < input.times01.size(); ++t) {
    for (const std::size_t s : kept) {
      weights.push_back(input.sub_shape_weights[t * input.sub_shapes.size() + s]);
    }
  }
  result.sub_shape_weights = weights;
  return result;
}

}  // namespace

std::optional<SkinnedArrays> skin_points(const SkinningInput& given, PrimLog& log) {
  if (!check_skinning(given, log)) return std::nullopt;
  std::vector<float> weights;
  const SkinningInput input = usable(given, log, weights);
  SkinnedArrays result;
  for (std::size_t t = 0; t < input.times01.size(); ++t) {
    const Rest rest = blended_rest(input, t);
    if (input.joint_indices.empty()) {
      add_posed(input, rest, RestPose{}, result);
      continue;
    }
    const std::span<const Matrix4d> joints = input.joints.subspan(t * input.joint_count, input.joint_count);
    if (input.method == SkinningMethod::kLinear) {
      add_posed(input, rest, LinearPose(input, joints), result);
    } else {
      add_posed(input, rest, RigidPose(input, joints), result);
    }
  }
  return result;
}

}  // namespace msbvh::translate
