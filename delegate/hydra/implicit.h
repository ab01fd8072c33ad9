// Implicit prims: sphere, cube, cone, cylinder, capsule, plane.
#pragma once

#include <optional>
#include <pxr/imaging/hd/rprim.h>

#include "delegate/hydra/shape.h"
#include "delegate/translate/shape/implicit_type.h"

namespace msbvh::hydra {

class RenderParam;

// Hydra's names of their types.
const TfTokenVector& implicit_types();

// The values of one. Hosts with scene indices alone hand them over as they are; the others make meshes of
// them.
class ImplicitValues : public Shape {
 public:
  ImplicitValues(const TfToken& type, const SdfPath& path) : Shape(path), type_(type) {}

 protected:
  void sync_topology(HdSceneDelegate&) override {}
  bool pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) override;
  // Hydra counts their parameters among the primvars.
  HdDirtyBits point_bits() const override { return Shape::point_bits() | HdChangeTracker::DirtyPrimvar; }
  void describe(translate::FrameShape& shape) const override { shape.implicit = input_; }
  bool wants_normals() const override { return false; }

 private:
  TfToken type_;
  std::optional<translate::ImplicitFrameInput> input_;
};

class Implicit : public HdRprim {
 public:
  Implicit(const TfToken& type, const SdfPath& path) : HdRprim(path), shape_(type, path) {}

  HdDirtyBits GetInitialDirtyBitsMask() const override { return kFirstBits; }
  const TfTokenVector& GetBuiltinPrimvarNames() const override;
  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) override;
  void UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) override;
  void Finalize(HdRenderParam* param) override;

 protected:
  HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }
  void _InitRepr(const TfToken& name, HdDirtyBits* bits) override;

 private:
  ImplicitValues shape_;
};

}  // namespace msbvh::hydra
