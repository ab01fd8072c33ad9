#include "delegate/translate/triangulate.h"

#include <algorithm>

namespace msbvh::translate {
namespace {

bool check_counts(const MeshInput& mesh, PrimLog& log) {
  std::int64_t sum = 0;
  for (std::size_t face = 0; face < mesh.face_vertex_counts.size(); ++face) {
    const int count = mesh.face_vertex_counts[face];
    if (count < 0) {
      return log.reject("faceVertexCounts", message("face ", face, " has ", count,
                                                    " vertices; expected a count that is not negative"));
    }
    sum += count;
  }
  if (sum == std::int64_t(mesh.face_vertex_indices.size())) return true;
  return log.reject("faceVertexCounts",
                    message("the counts add up to ", sum, "; expected ", mesh.face_vertex_indices.size(),
                            ", the number of faceVertexIndices"));
}

std::vector<bool> marked_holes(const MeshInput& mesh, PrimLog& log) {
  std::vector<bool> holes(mesh.face_vertex_counts.size(), false);
  std::size_t lost = 0;
  int first = 0;
  for (const int face : mesh.hole_indices) {
    if (face >= 0 && std::size_t(face) < holes.size()) {
      holes[std::size_t(face)] = true;
    } else if (lost++ == 0) {
      first = face;
    }
  }
  if (lost > 0) {
    const std::string others = lost > 1 ? message(" and ", lost - 1, " more") : std::string();
    log.warn("holeIndices", message("found face ", first, others, ", which is left out; expected 0 to ",
                                    std::ptrdiff_t(holes.size()) - 1));
  }
  return holes;
}

// Counts the faces that have no area by construction, and says so once.
class ThinFaces {
 public:
  void add(std::size_t face) {
    if (count_++ == 0) first_ = face;
  }
  void report(PrimLog& log) const {
    if (count_ == 0) return;
    log.warn("faceVertexCounts",
             message(count_, " faces with fewer than 3 vertices are left out (the first is face ", first_,
                     "); expected 3 or more"));
  }

 private:
  std::size_t count_ = 0, first_ = 0;
};

void add_fan(const MeshInput& mesh, std::uint32_t face, std::uint32_t start, Triangulation& result) {
  const auto vertex = [&](std::uint32_t corner) { return std::uint32_t(mesh.face_vertex_indices[corner]); };
  const std::uint32_t end = start + std::uint32_t(mesh.face_vertex_counts[face]);
  for (std::uint32_t corner = start + 1; corner + 1 < end; ++corner) {
    Triangle corners{start, corner, corner + 1};
    if (mesh.left_handed) std::swap(corners[1], corners[2]);
    result.triangles.push_back({vertex(corners[0]), vertex(corners[1]), vertex(corners[2])});
    result.corners.push_back(corners);
    result.faces.push_back(face);
  }
}

}  // namespace

bool check_topology(const MeshInput& mesh, std::size_t point_count, PrimLog& log) {
  if (!check_counts(mesh, log)) return false;
  const auto bad = std::ranges::find_if(
      mesh.face_vertex_indices, [&](int vertex) { return vertex < 0 || std::size_t(vertex) >= point_count; });
  if (bad == mesh.face_vertex_indices.end()) return true;
  const std::ptrdiff_t index = bad - mesh.face_vertex_indices.begin();
  if (point_count == 0) {
    return log.reject("points", message("no points; expected those that ", mesh.face_vertex_indices.size(),
                                        " faceVertexIndices refer to"));
  }
  return log.reject(mesh.indices_name, message("index ", index, " is ", *bad, "; expected 0 to ",
                                               point_count - 1, " (", point_count, " points)"));
}

Triangulation triangulate(const MeshInput& mesh, std::size_t point_count, PrimLog& log) {
  Triangulation result;
  result.face_count = mesh.face_vertex_counts.size();
  result.face_vertex_count = mesh.face_vertex_indices.size();
  result.point_count = point_count;
  const std::size_t bound = result.face_vertex_count;
  result.triangles.reserve(bound);
  result.faces.reserve(bound);
  result.corners.reserve(bound);

  const std::vector<bool> holes = marked_holes(mesh, log);
  ThinFaces thin;
  std::uint32_t start = 0;
  for (std::uint32_t face = 0; face < result.face_count; ++face) {
    if (mesh.face_vertex_counts[face] < 3) {
      thin.add(face);
    } else if (!holes[face]) {
      add_fan(mesh, face, start, result);
    }
    start += std::uint32_t(mesh.face_vertex_counts[face]);
  }
  thin.report(log);
  return result;
}

}  // namespace msbvh::translate
