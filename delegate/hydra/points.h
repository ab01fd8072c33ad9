// Points, drawn as spheres.
#pragma once

#include <pxr/imaging/hd/points.h>

#include "delegate/hydra/shape.h"

namespace msbvh::hydra {

class RenderParam;

// The values of points.
class PointsShape : public Shape {
 public:
  using Shape::Shape;

 protected:
  void sync_topology(HdSceneDelegate&) override {}
  void describe(translate::FrameShape& shape) const override;
};

class Points : public HdPoints {
 public:
  explicit Points(const SdfPath& path) : HdPoints(path), shape_(path) {}

  HdDirtyBits GetInitialDirtyBitsMask() const override { return kFirstBits; }
  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) override;
  void UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) override;
  void Finalize(HdRenderParam* param) override;

 protected:
  HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }
  void _InitRepr(const TfToken& name, HdDirtyBits* bits) override;

 private:
  PointsShape shape_;
};

}  // namespace msbvh::hydra
