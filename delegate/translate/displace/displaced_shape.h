// A mesh's shape where displacement moves its surface.
#pragma once

#include <optional>

#include "delegate/translate/mesh_shape.h"
#include "delegate/translate/point_motion.h"

namespace msbvh::translate {

struct DisplacedShape {
  Shape shape;
  PointFit fit;
};

// Of `points`, in the space that is wanted; nothing where there is no displacement, or none that can be
// drawn.
std::optional<DisplacedShape> displaced_shape(const MeshInput& input, const FaceDisplacements& displacements,
                                              const MovingArray& points, const Tessellation& faces,
                                              const ScreenMeasure& measure, const FitSettings& settings,
                                              PrimLog& log);

}  // namespace msbvh::translate
