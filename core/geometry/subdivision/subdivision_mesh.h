// Cages of subdivision surfaces, as UsdGeomMesh describes them. What is intersected are triangles between
// points of their limit surface (refined_mesh.h), or grids of displaced ones (dice.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/motion/track.h"

namespace msbvh {

// UsdGeomMesh's subdivisionScheme, interpolateBoundary, triangleSubdivisionRule and
// faceVaryingLinearInterpolation.
enum class SubdivisionScheme : std::uint8_t { kCatmullClark, kLoop, kBilinear };
enum class BoundaryRule : std::uint8_t { kNone, kEdgeOnly, kEdgeAndCorner };
enum class TriangleRule : std::uint8_t { kCatmullClark, kSmooth };
enum class FaceVaryingRule : std::uint8_t {
  kNone,
  kCornersOnly,
  kCornersPlus1,
  kCornersPlus2,
  kBoundaries,
  kAll
};

// Values with seams: what USD calls face-varying. `indices`: which of `value_count` values each corner of
// each face has; corners of neighbours that share a value are smooth across their edge.
struct FaceVaryingTopology {
  std::uint32_t value_count = 0;
  std::vector<std::uint32_t> indices;  // one a corner, as face_vertex_indices

  bool operator==(const FaceVaryingTopology&) const = default;
};

// Edges of a face, and faces around a vertex, at most. What OpenSubdiv takes to prepare a face that has, or
// touches, more grows with the third power of them, and all faces around may be prepared apart: a fan of 512
// uneven triangles took a minute.
inline constexpr std::uint32_t kMaxValence = 256;

// What does not move of a cage.
struct Cage {
  std::string name;  // in messages: the prim's path
  std::uint32_t vertex_count = 0;
  SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
  BoundaryRule boundary = BoundaryRule::kEdgeAndCorner;
  TriangleRule triangle_rule = TriangleRule::kCatmullClark;
  FaceVaryingRule face_varying_rule = FaceVaryingRule::kCornersPlus1;
  bool left_handed = false;
  std::vector<std::uint32_t> face_vertex_counts;
  std::vector<std::uint32_t> face_vertex_indices;
  std::vector<std::uint32_t> holes;  // faces
  // Chains of vertices; a sharpness for each chain, or for each edge of each chain. 10 and more is infinite.
  std::vector<std::uint32_t> crease_lengths, crease_indices;
  std::vector<float> crease_sharpnesses;
  std::vector<std::uint32_t> corner_indices;
  std::vector<float> corner_sharpnesses;
  std::vector<FaceVaryingTopology> face_varying;
};

// A cage whose vertices move along tracks.
struct SubdivisionMesh : Cage {
  std::uint32_t segments = 0;  // 0 still, else 2^k; see core/motion/track.h
  std::uint32_t degree = 1;
  std::vector<Vec3f> positions;  // [form().controls()][vertex_count], control-major

  TrackForm form() const { return {segments, degree}; }
  std::size_t position_count() const { return std::size_t(form().controls()) * vertex_count; }
  const Vec3f* control_positions(std::uint32_t control) const {
    return positions.data() + std::size_t(control) * vertex_count;
  }
};

// Whether all but the names are equal.
bool same_topology(const Cage& a, const Cage& b);

// Checks the sizes and indices of all arrays, and kMaxValence. Throws Error naming the mesh, the array, what
// was found and what is expected.
void validate(const Cage& cage);
// The form and the positions, too: every coordinate is finite and at most kMaxCoordinate in size.
void validate(const SubdivisionMesh& mesh);

}  // namespace msbvh
