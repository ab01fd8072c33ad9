#include "core/geometry/subdivision/subdivision_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {
namespace {

[[noreturn]] void fail(const Cage& mesh, const std::string& what) {
  throw Error((mesh.name.empty() ? std::string("mesh") : mesh.name) + ": " + what);
}

std::string text(std::uint64_t n) { return std::to_string(n); }

void require_size(const Cage& mesh, const char* array, std::size_t found, std::size_t expected) {
  if (found != expected)
    fail(mesh, std::string(array) + ": found " + text(found) + "; expected " + text(expected));
}

void require_below(const Cage& mesh, const char* array, const std::vector<std::uint32_t>& indices,
                   std::size_t limit) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < limit) continue;
    fail(mesh, std::string(array) + ": element " + text(i) + " is " + text(indices[i]) +
                   "; expected less than " + text(limit));
  }
}

std::size_t sum(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t(0));
}

void check_positions(const SubdivisionMesh& mesh) {
  if (!is_valid_form(mesh.form())) {
    fail(mesh, "segments, degree: found " + text(mesh.segments) + ", " + text(mesh.degree) +
                   "; expected 0 or a power of two up to " + text(kMaxSegments) + ", and 1 to " +
                   text(kMaxDegree));
  }
  require_size(mesh, "positions", mesh.positions.size(), mesh.position_count());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p = abs(mesh.positions[i]);
    const bool fits = p.x <= kMaxCoordinate && p.y <= kMaxCoordinate && p.z <= kMaxCoordinate;  // not NaN
    if (!fits)
      fail(mesh, "positions: vertex " + text(i % mesh.vertex_count) +
                     " has a coordinate that is not a finite number of at most 2^60 in size");
  }
}

void check_valences(const Cage& mesh) {
  std::vector<std::uint32_t> faces(mesh.vertex_count, 0);
  for (const std::uint32_t v : mesh.face_vertex_indices) ++faces[v];
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    if (faces[v] > kMaxValence)
      fail(mesh, "faceVertexIndices: " + text(faces[v]) + " faces share vertex " + text(v) +
                     "; expected at most " + text(kMaxValence));
  }
}

// OpenSubdiv 3.5 takes some faces that visit a vertex twice, and reads and writes beyond its memory when it
// prepares surfaces beside them, at creases above all (docs/design/bad_input.md).
void check_distinct(const Cage& mesh) {
  std::vector<std::uint32_t> corners;
  auto first = mesh.face_vertex_indices.begin();
  for (std::size_t f = 0; f < mesh.face_vertex_counts.size(); ++f) {
    const auto end = first + std::ptrdiff_t(mesh.face_vertex_counts[f]);
    corners.assign(first, end);
    std::ranges::sort(corners);
    const auto twice = std::ranges::adjacent_find(corners);
    if (twice != corners.end())
      fail(mesh, "faceVertexIndices: face " + text(f) + " has vertex " + text(*twice) +
                     " twice; expected distinct vertices");
    first = end;
  }
}

void check_faces(const Cage& mesh) {
  if (mesh.face_vertex_counts.empty()) fail(mesh, "faceVertexCounts: found no faces; expected some");
  for (std::size_t f = 0; f < mesh.face_vertex_counts.size(); ++f) {
    const std::uint32_t n = mesh.face_vertex_counts[f];
    const bool loop = mesh.scheme == SubdivisionScheme::kLoop;
    if (n < 3 || n > (loop ? 3 : kMaxValence))
      fail(mesh, "faceVertexCounts: face " + text(f) + " has " + text(n) + " vertices; expected 3" +
                     (loop ? " (loop)" : " to " + text(kMaxValence)));
  }
  require_size(mesh, "faceVertexIndices", mesh.face_vertex_indices.size(), sum(mesh.face_vertex_counts));
  require_below(mesh, "faceVertexIndices", mesh.face_vertex_indices, mesh.vertex_count);
  require_below(mesh, "holeIndices", mesh.holes, mesh.face_vertex_counts.size());
  check_distinct(mesh);
  check_valences(mesh);
}

void check_features(const Cage& mesh) {
  for (const std::uint32_t n : mesh.crease_lengths) {
    if (n < 2) fail(mesh, "creaseLengths: found a crease of " + text(n) + " vertices; expected 2 or more");
  }
  require_size(mesh, "creaseIndices", mesh.crease_indices.size(), sum(mesh.crease_lengths));
  require_below(mesh, "creaseIndices", mesh.crease_indices, mesh.vertex_count);
  const std::size_t edges = mesh.crease_indices.size() - mesh.crease_lengths.size();
  if (mesh.crease_sharpnesses.size() != edges)
    require_size(mesh, "creaseSharpnesses", mesh.crease_sharpnesses.size(), mesh.crease_lengths.size());
  require_below(mesh, "cornerIndices", mesh.corner_indices, mesh.vertex_count);
  require_size(mesh, "cornerSharpnesses", mesh.corner_sharpnesses.size(), mesh.corner_indices.size());
  const auto positive = [](float s) { return s >= 0.0f; };
  if (!std::ranges::all_of(mesh.crease_sharpnesses, positive) ||
      !std::ranges::all_of(mesh.corner_sharpnesses, positive))
    fail(mesh, "creaseSharpnesses, cornerSharpnesses: found a negative one; expected 0 or more");
}

void check_face_varying(const Cage& mesh) {
  for (const FaceVaryingTopology& t : mesh.face_varying) {
    require_size(mesh, "face-varying indices", t.indices.size(), mesh.face_vertex_indices.size());
    require_below(mesh, "face-varying indices", t.indices, t.value_count);
  }
}

}  // namespace

bool same_topology(const Cage& a, const Cage& b) {
  const auto all = [](const Cage& c) {
    return std::tie(c.vertex_count, c.scheme, c.boundary, c.triangle_rule, c.face_varying_rule, c.left_handed,
                    c.face_vertex_counts, c.face_vertex_indices, c.holes, c.crease_lengths, c.crease_indices,
                    c.crease_sharpnesses, c.corner_indices, c.corner_sharpnesses, c.face_varying);
  };
  return all(a) == all(b);
}

void validate(const Cage& cage) {
  check_faces(cage);
  check_features(cage);
  check_face_varying(cage);
}

void validate(const SubdivisionMesh& mesh) {
  check_positions(mesh);
  validate(static_cast<const Cage&>(mesh));
}

}  // namespace msbvh
