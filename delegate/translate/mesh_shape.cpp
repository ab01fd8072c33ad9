#include "delegate/translate/mesh_shape.h"

#include <algorithm>
#include <utility>

#include "delegate/translate/displace/as_grids.h"
#include "delegate/translate/material_primvars.h"
#include "delegate/translate/point_motion.h"
#include "delegate/translate/primvars.h"

namespace msbvh::translate {
namespace {

std::vector<Vec3f> refined_controls(const RefinedMesh& refined, const std::vector<Vec3f>& cage,
                                    std::uint32_t controls) {
  std::vector<Vec3f> out(std::size_t(controls) * refined.point_count() + TriangleMesh::kGuard);
  std::vector<const float*> from;
  std::vector<float*> to;
  for (std::size_t c = 0; c < controls; ++c) {
    from.push_back(&cage[c * refined.cage().vertex_count].x);
    to.push_back(&out[c * refined.point_count()].x);
  }
  refined.at_points({}, 3, from, to);
  return out;
}

// One material a triangle, or the mesh's own where all triangles have the same.
void add_face_materials(const MeshInput& input, const Tessellation& topology, std::uint32_t material_count,
                        Mesh& mesh, PrimLog& optional) {
  const std::span<const int> given = input.face_materials;
  if (given.empty()) return;
  const auto largest = std::ranges::max_element(given);
  const std::size_t face_count = topology.polygons().face_count;
  if (given.size() != face_count || *largest >= std::int64_t(material_count)) {
    optional.reject("material:binding",
                    message("found ", given.size(), " materials of faces, the largest ", *largest,
                            "; expected ", face_count, " and less than ", material_count));
    return;
  }
  const auto of_face = [&](std::uint32_t face) {
    return given[face] < 0 ? kNone : std::uint32_t(given[face]);
  };
  mesh.material = of_face(topology.faces().front());
  const bool alike = std::ranges::all_of(topology.faces(),
                                         [&](std::uint32_t face) { return of_face(face) == mesh.material; });
  if (alike) return;
  mesh.triangle_materials.reserve(topology.faces().size());
  for (const std::uint32_t face : topology.faces()) mesh.triangle_materials.push_back(of_face(face));
}

// Smooth, but where polygons are to be flat. Authored ones are not those of the displaced surface.
Primvar<Vec3f> displaced_normals(const MeshInput& input, const Tessellation& topology, const Shape& shape,
                                 std::uint32_t max_segments, PrimLog& log) {
  const bool flat =
      !topology.refinement() && input.computed_normals != Normals::kSmooth && input.normals.samples.empty();
  return flat ? Primvar<Vec3f>{} : smooth_normals(shape.mesh, max_segments, log);
}

Primvar<Vec3f> normals_of(const MeshInput& input, const Tessellation& topology, const NormalMotion& motion,
                          const Shape& shape, std::uint32_t max_segments, PrimLog& log) {
  if (shape.displaced_by > 0.0) return displaced_normals(input, topology, shape, max_segments, log);
  if (const Refinement* refinement = topology.refinement())
    return limit_normals(*refinement->mesh, shape.cage, shape.mesh.form(), max_segments, log);
  Primvar<Vec3f> authored = authored_normals(input, topology.polygons(), motion, max_segments, log);
  if (authored.authored() || input.computed_normals != Normals::kSmooth) return authored;
  return smooth_normals(shape.mesh, max_segments, log);
}

// About what a tree of triangles takes: docs/performance.md has 41 to 44 bytes a triangle at 1 key, 67 to 73
// at 2, 231 to 245 at 9.
std::uint64_t triangle_bytes(const TriangleMesh& mesh, std::size_t triangles) {
  constexpr std::uint64_t kEach = 20, kEachKey = 24;
  return triangles * (kEach + kEachKey * mesh.form().controls());
}

bool becomes_patches(const Tessellation& topology, const Shape& shape, const MeshTarget& target) {
  if (shape.displaced_by == 0.0 || !topology.refinement()) return false;
  if (target.displaced != Displaced::kByMemory) return target.displaced == Displaced::kAsPatches;
  const std::uint64_t bytes = triangle_bytes(shape.mesh, topology.triangles().size());
  if (bytes > *target.triangle_bytes_left) return true;
  *target.triangle_bytes_left -= bytes;
  return false;
}

}  // namespace

// All but the positions.
Shape empty_shape(const Candidate& track, const Tessellation& faces, const std::string& name) {
  Shape shape;
  shape.mesh.name = name;
  shape.mesh.segments = track.form().segments;
  shape.mesh.degree = track.form().degree;
  shape.mesh.triangles = faces.triangles();
  return shape;
}

Shape shape_of(const MovingArray& points, const Candidate& track, const Tessellation& faces,
               const std::string& name) {
  Shape shape = empty_shape(track, faces, name);
  TriangleMesh& mesh = shape.mesh;
  mesh.vertex_count = std::uint32_t(points.size());
  mesh.positions = point_controls(points, track);
  if (const Refinement* refinement = faces.refinement()) {
    shape.cage = std::move(mesh.positions);
    mesh.vertex_count = refinement->mesh->point_count();
    mesh.positions = refined_controls(*refinement->mesh, shape.cage, mesh.form().controls());
  }
  return shape;
}

std::uint32_t material_of(const MeshInput& input, const MeshTarget& target, PrimLog& optional) {
  if (input.material == kNone || input.material < target.material_count) return input.material;
  optional.reject("material:binding",
                  message("found material ", input.material, "; expected less than ", target.material_count));
  return kNone;
}

void add_shape(const MeshInput& input, Tessellation& topology, const NormalMotion& motion,
               const MeshTarget& target, Shape shape, TranslatedMesh& result, PrimLog& log) {
  const std::uint32_t most = target.settings.max_segments;
  const bool grids = becomes_patches(topology, shape, target);
  if (grids) topology.draw_as_grids();
  Mesh& mesh = result.mesh;
  mesh.normals = normals_of(input, topology, motion, shape, most, log);
  mesh.displaced_by = float(shape.displaced_by);
  mesh.shape = std::move(shape.mesh);
  PrimLog optional = log.of_optional_part();
  mesh.display_color = flattened(input.display_color, topology, "primvars:displayColor", optional, most);
  mesh.display_opacity =
      flattened(input.display_opacity, topology, "primvars:displayOpacity", optional, most);
  mesh.primvars = material_primvars(input, *target.materials, [&](const NamedPrimvar& named) {
    return flattened(named.primvar, topology, full_name(named), optional, most);
  });
  mesh.material = material_of(input, target, optional);
  add_face_materials(input, topology, target.material_count, mesh, optional);
  if (target.keep_faces) mesh.triangle_faces = topology.faces();
  if (topology.refinement()) mesh.cage_faces = std::uint32_t(topology.polygons().face_count);
  if (grids) result.grids = as_grids(std::exchange(mesh, {}), *topology.grids());
}

}  // namespace msbvh::translate
