#include "delegate/hydra/points.h"

#include <algorithm>

namespace msbvh::hydra {

void PointsShape::describe(translate::FrameShape& shape) const {
  translate::MeshInput& mesh = shape.mesh;
  mesh.round.kind = translate::RoundInput::Kind::kPoints;
  mesh.round.widths = primvar_input<float>(widths().values, widths().interpolation);
}

}  // namespace msbvh::hydra
