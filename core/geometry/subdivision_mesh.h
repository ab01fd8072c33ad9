// Cages of subdivision surfaces whose vertices move along tracks, as UsdGeomMesh describes them. What is
// intersected is a grid of points on their limit surface: core/geometry/dice.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/motion/track.h"

namespace msbvh {

// UsdGeomMesh's subdivisionScheme, interpolateBoundary and triangleSubdivisionRule.
enum class SubdivisionScheme : std::uint8_t { kCatmullClark, kLoop, kBilinear };
enum class BoundaryRule : std::uint8_t { kNone, kEdgeOnly, kEdgeAndCorner };
enum class TriangleRule : std::uint8_t { kCatmullClark, kSmooth };

struct SubdivisionMesh {
  std::string name;            // in messages: the prim's path
  std::uint32_t segments = 0;  // 0 still, else 2^k; see core/motion/track.h
  std::uint32_t degree = 1;
  std::uint32_t vertex_count = 0;
  std::vector<Vec3f> positions;  // [form().controls()][vertex_count], control-major

  SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
  BoundaryRule boundary = BoundaryRule::kEdgeAndCorner;
  TriangleRule triangle_rule = TriangleRule::kCatmullClark;
  bool left_handed = false;
  std::vector<std::uint32_t> face_vertex_counts;
  std::vector<std::uint32_t> face_vertex_indices;
  std::vector<std::uint32_t> holes;  // faces
  // Chains of vertices; a sharpness for each chain, or for each edge of each chain. 10 and more is infinite.
  std::vector<std::uint32_t> crease_lengths, crease_indices;
  std::vector<float> crease_sharpnesses;
  std::vector<std::uint32_t> corner_indices;
  std::vector<float> corner_sharpnesses;

  TrackForm form() const { return {segments, degree}; }
  std::size_t position_count() const { return std::size_t(form().controls()) * vertex_count; }
};

// Checks the form, the sizes and indices of all arrays, and that every coordinate is finite and at most
// kMaxCoordinate in size. Throws Error naming the mesh, the array, what was found and what is expected.
void validate(const SubdivisionMesh& mesh);

}  // namespace msbvh
