// How far a cage that is drawn as polygons strays from its limit surface.
//
// Both ways, since a cage is coarse: places of the surface (a lattice of 4 x 4 on each face, with its
// corners, the middles of its edges and its centre) to the nearest point of the polygons of the faces around,
// and vertices of the cage, which stand out the farthest, to the nearest point of the surface around, as
// triangles of that lattice: those lie off the surface by a sixteenth of what the faces do. Faces that the
// boundary rule leaves without a surface have nothing to stray from and are left out.
#pragma once

#include <optional>
#include <span>

#include "delegate/translate/inputs.h"
#include "delegate/translate/stray/stray.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {

// In pixels; nothing for a cage that cannot be subdivided. The poses are of the input's points.
std::optional<double> cage_stray(const MeshInput& input, const Triangulation& polygons,
                                 std::size_t point_count, std::span<const StrayInstant> instants);

}  // namespace msbvh::translate
