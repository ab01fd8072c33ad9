// How far the triangles between points of a limit surface stray from it.
//
// For each triangle the surface is evaluated half way along its three edges and at its middle (in the
// surface's parameters), and the distance is that to the triangle's plane, not to the point of the triangle
// that has the same parameters: where parameters are only spread unevenly nothing is seen. A triangle's plane
// goes on in its neighbours to first order, so that a point that lies beside its triangle is not off for
// that; along edges where the surface ends or bends (LimitSurface::is_sharp()) there is no such neighbour,
// and the distance is to the triangle itself. Corners lie on the surface. What is greatest between these
// places may be a little more: by a few per cent, where the surface curves evenly over a triangle.
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
