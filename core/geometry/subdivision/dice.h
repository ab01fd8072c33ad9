// From a cage to grids of displaced points on its limit surface, at every key.
#pragma once

#include <cstdint>
#include <functional>

#include "core/base/vec.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh {

// A place on the limit surface at a control of the track.
struct SurfacePoint {
  std::uint32_t face, square;  // of several faces that meet here, the first
  double s, t;                 // in the square, see FaceSurface::evaluate
  std::uint32_t control;
  Vec3d position, normal;  // unit; the mean of the faces' own where they differ, at creases
};

struct DiceSettings {
  // Segments of each edge: 2^level, 0 to kMaxEdgeLevel. Four times the quads, bytes and time for each.
  std::uint32_t level = 3;
  // Overrides `level` for the edge between two vertices of the cage; must not depend on their order.
  std::function<std::uint32_t(std::uint32_t, std::uint32_t)> edge_level{};
  // Distance along the normal. Called once for each point of the mesh and each key, from several threads.
  std::function<double(const SurfacePoint&)> displacement{};
};

// Limit points are linear in the cage's controls, so undisplaced grids move exactly as the limit surface
// does, on tracks of any degree. Displaced points are exact at the keys and move linearly between them: a
// normal that turns a lot wants more keys of the cage.
//
// Throws Error for a cage that is not valid, a displacement that is not finite, and for displacement on a
// track of degree 2 or 3, whose controls are not places of the surface.
GridMesh dice(const SubdivisionMesh& mesh, const DiceSettings& settings);

}  // namespace msbvh
