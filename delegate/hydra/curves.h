// BasisCurves. Hydra has no Hermite curves, and NURBS curves only where a scene index makes basis curves of
// them.
#pragma once

#include <pxr/imaging/hd/basisCurves.h>

#include "delegate/hydra/drawn.h"

namespace msbvh::hydra {

// The values of curves.
class CurvesShape : public Shape {
 public:
  using Shape::Shape;

 protected:
  void sync_topology(HdSceneDelegate& delegate) override;
  void describe(translate::FrameShape& shape) const override;
  bool pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) override;

 private:
  HdBasisCurvesTopology topology_;
};

using Curves = Drawn<HdBasisCurves, CurvesShape>;

}  // namespace msbvh::hydra
