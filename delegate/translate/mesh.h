// One USD mesh to one mesh of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "core/base/vec.h"
#include "core/geometry/subdivision/refinement_cache.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/displace/face_displacements.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/material_table.h"
#include "delegate/translate/outside.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {

// Where translated meshes go.
struct MeshTarget {
  // Null: a prototype's own space.
  const ScreenMeasure* measure = nullptr;
  // Of a prototype; 0: not known, so that a mesh is measured as if it filled the image.
  double pixels_per_unit = 0.0;
  // Subtracted in double. A prototype's is chosen by its first mesh.
  std::optional<Vec3d> origin;
  std::uint32_t width = 1, height = 1;
  FitSettings settings;
  std::uint32_t material_count = 0;
  bool keep_faces = false;
  bool measure_shape = false;
  double edge_length_pixels = 0.0;  // of subdivided surfaces; 0: their cages are drawn as polygons
  Displacements displacements{};    // by material; none: nothing is displaced
  Displaced displaced = Displaced::kAsTriangles;
  std::uint64_t* triangle_bytes_left = nullptr;  // of Displaced::kByMemory, for all meshes of a frame
  CurveStyle curves = CurveStyle::kRibbon;
  RefinementCache* refinements = nullptr;    // not null; of all meshes and frames of a front-end
  const Outside* outside = nullptr;          // of the world; null: one tolerance for all
  const MaterialTable* materials = nullptr;  // not null
};

// One of `mesh`, `grids`, `curves` and `points` is what it became: the mesh where the others are not.
struct TranslatedMesh {
  Mesh mesh;
  std::optional<Grids> grids{};  // in place of the mesh
  std::optional<Curves> curves{};
  std::optional<Points> points{};
  TrackReport track;
  // In a moving transform: the mesh stays in its object's space and these are the track's controls. Empty:
  // baked into the target.
  std::vector<Affine3f> world_from_mesh;
  // Of whichever of both moves, with visibility; the shutter's own where neither asks for another.
  TimeRemap time_remap;
  bool never_seen = false;  // invisible throughout the shutter

  const std::string& name() const;
  Appearance& look();  // of whichever it became
  Box3d box() const;   // around all that it draws, at all of its controls
};

// The motion of a mesh is kept in one of three ways, the first that is exact:
//   still points, still transform: baked, one key;
//   still points, moving transform, in the world: one still mesh under the transform's track;
//   else: baked, with a track that follows both.
// A transform that is singular at some time is baked too: it has no inverse to trace rays through.
// Returns nothing for a mesh that cannot be used (an error in the log) or has nothing to draw.
std::optional<TranslatedMesh> translate_mesh(const MeshInput& input, MeshTarget& target, PrimLog& log);

// Origin for coordinates that are large but close together: per axis 0, or the middle of the box where the
// box lies at least its own size away from 0. Two floats in such a box are within a factor of 2, so that
// their difference is exact in single precision (Sterbenz's lemma): the shift costs nothing.
Vec3d exact_origin(const Box3d& box);

}  // namespace msbvh::translate
