// How far the triangles between points of a displaced limit surface stray from it.
//
// As refined_stray.h has it, half way along the edges and at the triangles' corners, with the displacement
// that the material says there. What a texture says depends on the width that it is filtered over, and so
// does the surface: held against the triangles is the surface of twice their rate, filtered half as wide.
// Bumps that are narrower than that are seen by neither. Distances are the face's own, where points on a seam
// of texture coordinates are drawn by the mean of what the faces there say (displace/distances.h).
#pragma once

#include <vector>

#include "delegate/translate/displace/face_displacements.h"
#include "delegate/translate/stray/stray.h"

namespace msbvh::translate {

// In pixels; of a refinement alone. `points`: of the mesh, as stray_pixels() has them.
double displaced_stray(const MeshInput& input, const FaceDisplacements& displacements,
                       const Tessellation& drawn, const MovingArray& points, const ScreenMeasure& measure);

}  // namespace msbvh::translate
