#include "delegate/translate/tessellation.h"

#include <utility>

#include "core/base/error.h"
#include "delegate/translate/cage.h"
#include "delegate/translate/edge_levels.h"

namespace msbvh::translate {
namespace {

// An Error of the core names the mesh first; the log does so itself.
std::string without_name(const std::string& what, const std::string& name) {
  const std::string start = name + ": ";
  return what.starts_with(start) ? what.substr(start.size()) : what;
}

std::vector<std::uint32_t> input_faces(const RefinedMesh& mesh, const std::vector<std::uint32_t>& faces) {
  if (faces.empty()) return mesh.faces();
  std::vector<std::uint32_t> result;
  result.reserve(mesh.faces().size());
  for (const std::uint32_t face : mesh.faces()) result.push_back(faces[face]);
  return result;
}

}  // namespace

void Tessellation::draw_as_grids() {
  grids_ = refinement_->mesh->grid_layout();
  const std::vector<std::uint32_t>& faces = refinement_->cage_faces;
  for (const Grid& grid : grids_->grids) grid_faces_.push_back(faces.empty() ? grid.face : faces[grid.face]);
}

Tessellation tessellated(const MeshInput& input, Triangulation polygons, const MovingArray& points,
                         const EdgeLength& edges, std::uint32_t controls, RefinementCache& kept,
                         PrimLog& log) {
  if (!(edges.pixels > 0.0)) return Tessellation(std::move(polygons));
  std::optional<InputCage> cage = cage_of(input, points.size(), log);
  if (!cage) return Tessellation(std::move(polygons));
  try {
    const EdgeRule rule(input, points, edges);
    std::shared_ptr<const RefinedMesh> mesh = kept.mesh(
        std::move(cage->cage), rule.poses(), [&](const CageEdge& edge) { return rule.level(edge); },
        kMostRefinedPoints / controls);
    if (mesh->lowered() > 0) {
      log.warn("subdivisionScheme",
               message("edges of ", edges.pixels, " pixels take more than ", kMostRefinedPoints / controls,
                       " points; drawn with edges ", 1u << mesh->lowered(),
                       " times as long; a larger --edge-length says so without this warning"));
    }
    std::vector<std::uint32_t> faces = input_faces(*mesh, cage->faces);
    return {std::move(polygons),
            {std::move(mesh), std::move(faces), std::move(cage->faces), std::move(cage->channels)}};
  } catch (const Error& error) {
    const std::string what = without_name(error.what(), input.path);
    log.warn("subdivisionScheme", message(what, "; the cage is drawn as polygons"));
    return Tessellation(std::move(polygons));
  }
}

}  // namespace msbvh::translate
