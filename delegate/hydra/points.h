// Points, drawn as spheres.
#pragma once

#include <pxr/imaging/hd/points.h>

#include "delegate/hydra/drawn.h"

namespace msbvh::hydra {

// The values of points.
class PointsShape : public Shape {
 public:
  using Shape::Shape;

 protected:
  void sync_topology(HdSceneDelegate&) override {}
  void describe(translate::FrameShape& shape) const override;
};

using Points = Drawn<HdPoints, PointsShape>;

}  // namespace msbvh::hydra
