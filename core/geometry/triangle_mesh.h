// Triangle meshes whose vertices move along tracks. The only geometry that the accelerator knows today.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/box.h"
#include "core/base/lerp.h"
#include "core/base/vec.h"
#include "core/motion/bezier.h"
#include "core/motion/track.h"

namespace msbvh {

using Triangle = std::array<std::uint32_t, 3>;

struct TriangleMesh {
  std::string name;            // in messages: the prim's path
  std::uint32_t segments = 0;  // 0 still, else 2^k; see core/motion/track.h
  std::uint32_t degree = 1;    // of the Bezier curves on the segments; 1 linear
  std::uint32_t vertex_count = 0;
  // [form().controls()][vertex_count], control-major, then kGuard unused elements.
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;  // vertex indices

  // Elements behind the last vertex, so that a 16-byte load of any position stays inside the array.
  static constexpr std::size_t kGuard = 1;

  TrackForm form() const { return {segments, degree}; }
  // Of all controls, without the guard.
  std::size_t position_count() const { return std::size_t(form().controls()) * vertex_count; }
  const Vec3f* control_positions(std::uint32_t control) const {
    return positions.data() + std::size_t(control) * vertex_count;
  }
  Vec3f position(std::uint32_t vertex, float u) const {
    if (segments == 0) return positions[vertex];
    const SegmentTime at = locate(u, segments);
    const Vec3f* first = control_positions(at.key * degree) + vertex;
    return bezier([&](std::uint32_t i) { return first[std::size_t(i) * vertex_count]; }, degree, at.w);
  }
};

// The one gate through which geometry enters. Checks the form, that `positions` holds every control and
// the guard, that every coordinate is finite and at most kMaxCoordinate in size, and that every index is in
// range. Throws Error naming the mesh, the array, what was found and what is expected.
void validate(const TriangleMesh& mesh);
// The mesh with the guard, which is appended where it is missing, validated.
TriangleMesh validated(TriangleMesh mesh);

// Squares and products of coordinates must not overflow in single precision (the triangle test multiplies two
// differences of coordinates).
inline constexpr float kMaxCoordinate = 0x1p60f;

}  // namespace msbvh
