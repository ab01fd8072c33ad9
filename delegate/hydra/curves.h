// BasisCurves. Hydra has no Hermite curves, and NURBS curves only where a scene index makes basis curves of
// them.
#pragma once

#include <pxr/imaging/hd/basisCurves.h>

#include "delegate/hydra/shape.h"

namespace msbvh::hydra {

class RenderParam;

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

class Curves : public HdBasisCurves {
 public:
  explicit Curves(const SdfPath& path) : HdBasisCurves(path), shape_(path) {}

  HdDirtyBits GetInitialDirtyBitsMask() const override { return kFirstBits; }
  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) override;
  void UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) override;
  void Finalize(HdRenderParam* param) override;

 protected:
  HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }
  void _InitRepr(const TfToken& name, HdDirtyBits* bits) override;

 private:
  CurvesShape shape_;
};

}  // namespace msbvh::hydra
