// What Hydra calls on a prim that is drawn, for each of its base classes: all of it is Shape's work.
#pragma once

#include <algorithm>
#include <optional>
#include <pxr/imaging/hd/changeTracker.h>
#include <pxr/imaging/hd/instancer.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/repr.h>
#include <utility>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/shape.h"

namespace msbvh::hydra {

// `Base`: HdMesh, HdBasisCurves, HdPoints or HdRprim, which keep their helpers in protected members.
// `Values`: a Shape.
template <typename Base, typename Values>
class Drawn : public Base {
 public:
  explicit Drawn(const SdfPath& path) : Base(path), shape_(path) {}

  HdDirtyBits GetInitialDirtyBitsMask() const override { return kFirstBits; }

  void Sync(HdSceneDelegate* delegate, HdRenderParam* host_param, HdDirtyBits* bits,
            const TfToken&) override {
    auto& param = *static_cast<RenderParam*>(host_param);
    const SdfPath& path = this->GetId();
    this->_UpdateInstancer(delegate, bits);
    HdInstancer::_SyncInstancerAndParents(delegate->GetRenderIndex(), this->GetInstancerId());
    if (*bits & HdChangeTracker::DirtyMaterialId) this->SetMaterialId(delegate->GetMaterialId(path));
    const bool visible =
        *bits & HdChangeTracker::DirtyVisibility ? delegate->GetVisible(path) : shape_.visible();
    shape_.set_links(this->GetInstancerId(), this->GetMaterialId(), visible);
    shape_.set_render_tag(this->GetRenderTag(), param);
    shape_.sync(*delegate, *bits, this->GetPrimId());
    param.note_shape(shape_, *bits);
    if (const std::optional<Shutter> shutter = param.last_shutter()) shape_.pull(*shutter);
    *bits &= ~HdChangeTracker::AllSceneDirtyBits;
  }

  // Hydra looks tags up outside of Sync, and may sync nothing then.
  void UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) override {
    Base::UpdateRenderTag(delegate, param);
    shape_.set_render_tag(this->GetRenderTag(), *static_cast<RenderParam*>(param));
  }

  void Finalize(HdRenderParam* param) override { static_cast<RenderParam*>(param)->forget_shape(shape_); }

 protected:
  Drawn(const SdfPath& path, Values values) : Base(path), shape_(std::move(values)) {}

  HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }

  void _InitRepr(const TfToken& name, HdDirtyBits*) override {
    if (std::none_of(this->_reprs.begin(), this->_reprs.end(), typename Base::_ReprComparator(name)))
      this->_reprs.emplace_back(name, HdReprSharedPtr());
  }

 private:
  Values shape_;
};

}  // namespace msbvh::hydra
