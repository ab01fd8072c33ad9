// What a mesh is drawn as: its polygons, cut into triangles, or triangles of its limit surface.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/subdivision/refined_mesh.h"
#include "core/geometry/subdivision/refinement_cache.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {

// A cage refined.
struct Refinement {
  std::shared_ptr<const RefinedMesh> mesh;
  std::vector<std::uint32_t> faces;       // of each triangle, the input's face
  std::vector<std::uint32_t> cage_faces;  // of each of the cage's faces, likewise; empty: the same
  std::map<std::string, std::uint32_t>
      channels;  // of face-varying primvars, by attribute: ValueKind::channel
};

class Tessellation {
 public:
  explicit Tessellation(Triangulation polygons) : polygons_(std::move(polygons)) {}
  Tessellation(Triangulation polygons, Refinement refinement)
      : polygons_(std::move(polygons)), refinement_(std::move(refinement)) {}

  // Of the input, whose sizes primvars have.
  const Triangulation& polygons() const { return polygons_; }
  const Refinement* refinement() const { return refinement_ ? &*refinement_ : nullptr; }
  // Draws a refinement as grids: what primvars have one value each of are then grids and their points.
  void draw_as_grids();
  const GridLayout* grids() const { return grids_ ? &*grids_ : nullptr; }
  const std::vector<Triangle>& triangles() const {
    return refinement_ ? refinement_->mesh->triangles() : polygons_.triangles;
  }
  // The input's face of each triangle, or of each grid.
  const std::vector<std::uint32_t>& faces() const {
    if (grids_) return grid_faces_;
    return refinement_ ? refinement_->faces : polygons_.faces;
  }

 private:
  Triangulation polygons_;
  std::optional<Refinement> refinement_;
  std::optional<GridLayout> grids_;
  std::vector<std::uint32_t> grid_faces_;
};

// How finely surfaces are cut.
struct EdgeLength {
  double pixels =
      0.0;  // of about what length edges are where they are seen largest; 0: cages are drawn as polygons
  const ScreenMeasure& measure;
  double reach = 0.0;  // how far off the limit surface something may be drawn, in the object's units
};

// The length in pixels by the name that usdrecord's --complexity gives it.
struct ComplexityEdge {
  std::string_view complexity;
  double pixels;
};
inline constexpr ComplexityEdge kComplexityEdges[] = {
    {"low", 0.0}, {"medium", 4.0}, {"high", 1.0}, {"veryhigh", 0.5}};

// More points than this, at all controls of a track together, are not made.
inline constexpr std::uint64_t kMostRefinedPoints = std::uint64_t(1) << 25;

// `points`: the cage's, in the world. Polygons, with a warning, for a cage that cannot be subdivided.
// `controls`: of the track that the points will have. Takes again what `kept` has of an equal cage.
Tessellation tessellated(const MeshInput& input, Triangulation polygons, const MovingArray& points,
                         const EdgeLength& edges, std::uint32_t controls, RefinementCache& kept,
                         PrimLog& log);

}  // namespace msbvh::translate
