// Implicit prims: sphere, cube, cone, cylinder, capsule, plane.
#pragma once

#include <optional>
#include <pxr/imaging/hd/rprim.h>

#include "delegate/hydra/drawn.h"
#include "delegate/translate/shape/implicit_type.h"

namespace msbvh::hydra {

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

class Implicit : public Drawn<HdRprim, ImplicitValues> {
 public:
  Implicit(const TfToken& type, const SdfPath& path) : Drawn(path, ImplicitValues(type, path)) {}

  const TfTokenVector& GetBuiltinPrimvarNames() const override;
};

}  // namespace msbvh::hydra
