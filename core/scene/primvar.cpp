#include "core/scene/primvar.h"

#include "core/base/error.h"

namespace msbvh {

std::size_t value_count(Interpolation interpolation, const TriangleMesh& shape) {
  switch (interpolation) {
    case Interpolation::kConstant:
      return 1;
    case Interpolation::kTriangle:
      return shape.triangles.size();
    case Interpolation::kVertex:
      return shape.vertex_count;
    case Interpolation::kFaceVarying:
      return 3 * shape.triangles.size();
  }
  throw Error(shape.name + ": interpolation: found an unknown value");
}

std::size_t value_count(Interpolation interpolation, const GridMesh& shape) {
  if (interpolation == Interpolation::kConstant) return 1;
  if (interpolation == Interpolation::kTriangle) return shape.grids.size();
  if (interpolation == Interpolation::kVertex)
    return (shape.values.size() - GridMesh::kGuard) / (3 * std::size_t(shape.form().controls()));
  throw Error(shape.name + ": interpolation: found one value a corner; expected one a grid or point");
}

std::size_t value_count(Interpolation interpolation, const CurveSet& shape) {
  if (interpolation == Interpolation::kConstant) return 1;
  if (interpolation == Interpolation::kTriangle) return shape.spans.size();
  if (interpolation == Interpolation::kVertex) return shape.vertex_count;
  throw Error(shape.name + ": interpolation: found one value a corner; expected one a span or vertex");
}

std::size_t value_count(Interpolation interpolation, const PointSet& shape) {
  if (interpolation == Interpolation::kConstant) return 1;
  if (interpolation == Interpolation::kTriangle) return shape.point_count;
  throw Error(shape.name + ": interpolation: found one value a vertex or corner; expected one a point");
}

}  // namespace msbvh
