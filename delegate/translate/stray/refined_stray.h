// How far the triangles between points of a limit surface stray from it.
//
// For each triangle the surface is evaluated half way along its three edges and at its middle (in the
// surface's parameters), and held against what is drawn there, not against the point of the triangle that has
// the same parameters: where parameters are only spread unevenly nothing is seen. That is the triangle's
// plane, which its neighbours continue to first order, since a place may lie beside its triangle; half way
// along an edge between two triangles of a face the nearer triangle, or the farther plane where it is beside
// both; on the rim of the surface and at creases (LimitSurface::is_sharp()), where nothing goes on, the
// triangle itself. Corners lie on the surface. Held against the nearest of all triangles from dense limit
// points, the result is 0.97 to 1.03 of that at edges that are short beside the surface's bends, and not less
// than 0.88 where two triangles are a whole face (tests/unit/test_stray.cpp).
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/subdivision/refined_mesh.h"
#include "delegate/translate/stray/stray.h"

namespace msbvh::translate {

// Around extraordinary vertices places half way are exact from one level more on than the finest edge's
// (LimitSurface::prepare()); a level more brings the middles of triangles as near.
inline constexpr std::uint32_t kStrayLevels = 2;

// In pixels. The poses are of the mesh's cage. Points are those of the stage at these times, so that the
// error of the track that they are drawn on does not count. Throws Error where OpenSubdiv refuses the cage.
double refined_stray(const RefinedMesh& mesh, std::span<const StrayInstant> instants);

}  // namespace msbvh::translate
