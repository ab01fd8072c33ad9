#include "delegate/hydra/points.h"

#include <algorithm>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/sync_shape.h"

namespace msbvh::hydra {

void PointsShape::describe(translate::FrameShape& shape) const {
  translate::MeshInput& mesh = shape.mesh;
  mesh.round.kind = translate::RoundInput::Kind::kPoints;
  mesh.round.widths = primvar_input<float>(widths().values, widths().interpolation);
}

void Points::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) {
  sync_shape(*this, shape_, *delegate, *static_cast<RenderParam*>(param), *bits,
             [&] { _UpdateInstancer(delegate, bits); });
}

// Hydra looks tags up outside of Sync, and may sync nothing then.
void Points::UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) {
  HdPoints::UpdateRenderTag(delegate, param);
  shape_.set_render_tag(GetRenderTag(), *static_cast<RenderParam*>(param));
}

void Points::Finalize(HdRenderParam* param) { static_cast<RenderParam*>(param)->forget_shape(shape_); }

void Points::_InitRepr(const TfToken& name, HdDirtyBits*) {
  if (std::none_of(_reprs.begin(), _reprs.end(), _ReprComparator(name)))
    _reprs.emplace_back(name, HdReprSharedPtr());
}

}  // namespace msbvh::hydra
