// Skinning as UsdSkel defines it: blend shapes, then joints by linear blending or by dual quaternions.
//
// Follows UsdSkel (UsdSkelSkinningQuery, UsdSkelBlendShapeQuery, UsdSkelSkinPoints, UsdSkelSkinNormals):
// blend shapes move the rest points in the mesh's own space; geom_bind takes them to the skeleton's space;
// there each joint's skinning transform moves them. Weights are used as they are, not normalised. Here sums
// are double and results rounded once.
//
// Normals depart from UsdSkel in one case: under dual quaternions the rotation of a joint that shears or
// mirrors is that of its points (the polar factor), where UsdSkel orthonormalises the matrix of normals on
// its own and takes no proper rotation from a mirror.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

enum class SkinningMethod : std::uint8_t {
  kLinear,         // classicLinear: transformed points are summed
  kDualQuaternion  // dualQuaternion: rotations and translations are blended, what remains of a joint's matrix
                   // (scale and shear) is summed as in kLinear and goes first
};

// A blend shape or one of its in-betweens.
struct SubShape {
  std::string path;                       // of the blend shape, for messages
  std::span<const Vec3f> offsets;         // of points, in the mesh's space; empty: none
  std::span<const Vec3f> normal_offsets;  // empty: none
  std::span<const int> point_indices;     // the point of each offset; empty: one offset a point
};

struct SkinningInput {
  std::string path;                    // of the mesh, for messages
  std::vector<double> times01;         // T, for messages and the length of what follows
  std::span<const Vec3f> points;       // N rest points, in the mesh's space
  std::span<const Vec3f> normals;      // M rest normals, or none
  std::span<const int> normal_points;  // M: the point that each normal belongs to; empty: one normal a point

  SkinningMethod method = SkinningMethod::kLinear;
  // [N][influences_per_point]; constant_influences: [influences_per_point], the same for every point. Empty:
  // no joints, blend shapes alone, and the result stays in the mesh's space.
  std::span<const int> joint_indices;
  std::span<const float> joint_weights;
  int influences_per_point = 1;
  bool constant_influences = false;
  Matrix4d geom_bind{1, 0, 0, 0, 0, 1, 0, 0,
                     0, 0, 1, 0, 0, 0, 0, 1};  // skeleton from mesh space, at bind time
  // [T][joint_count], in the order that joint_indices count in: the joint's inverse bind transform, then its
  // transform in the skeleton's space (UsdSkelSkeletonQuery::ComputeSkinningTransforms).
  std::span<const Matrix4d> joints;
  std::size_t joint_count = 0;

  std::vector<SubShape> sub_shapes;          // S
  std::span<const float> sub_shape_weights;  // [T][S]
};

struct SkinnedArrays {
  std::vector<std::vector<Vec3f>> points;   // [T][N], in the skeleton's space
  std::vector<std::vector<Vec3f>> normals;  // [T][M], unit length or zero; empty without rest normals
};

// Whether the prim can be skinned. Every failure but those of blend shapes and normals rejects the prim.
bool check_skinning(const SkinningInput& input, PrimLog& log);

// Nothing where check_skinning() fails. Blend shapes and normals that do not fit are left out with a warning.
std::optional<SkinnedArrays> skin_points(const SkinningInput& input, PrimLog& log);

// Whether a part that the prim can do without is usable. For a log of an optional part.
bool check_sub_shape(const SubShape& shape, std::size_t point_count, PrimLog& log);
bool check_rest_normals(const SkinningInput& input, PrimLog& log);

}  // namespace msbvh::translate
