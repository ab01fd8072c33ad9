#include "delegate/hydra/curves.h"

#include <algorithm>
#include <pxr/imaging/hd/basisCurvesSchema.h>
#include <pxr/imaging/hd/basisCurvesTopologySchema.h>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/sync_shape.h"

namespace msbvh::hydra {

void CurvesShape::sync_topology(HdSceneDelegate& delegate) {
  topology_ = delegate.GetBasisCurvesTopology(path());
}

bool CurvesShape::pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) {
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path());
  if (!prim) return false;
  HdBasisCurvesTopologySchema topology = HdBasisCurvesSchema::GetFromParent(prim).GetTopology();
  if (!topology) return false;
  return changes_within(topology.GetCurveVertexCounts(), shutter) ||
         changes_within(topology.GetCurveIndices(), shutter);
}

void CurvesShape::describe(translate::FrameShape& shape) const {
  translate::RoundInput& round = shape.mesh.round;
  round.kind = translate::RoundInput::Kind::kCurves;
  round.topology.type = topology_.GetCurveType().GetString();
  round.topology.basis = topology_.GetCurveBasis().GetString();
  round.topology.wrap = topology_.GetCurveWrap().GetString();
  round.topology.vertex_counts = span_of(topology_.GetCurveVertexCounts());
  round.topology.indices = span_of(topology_.GetCurveIndices());
  round.topology.hidden = span_of(topology_.GetInvisibleCurves());
  round.widths = primvar_input<float>(widths().values, widths().interpolation);
}

void Curves::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) {
  sync_shape(*this, shape_, *delegate, *static_cast<RenderParam*>(param), *bits,
             [&] { _UpdateInstancer(delegate, bits); });
}

// Hydra looks tags up outside of Sync, and may sync nothing then.
void Curves::UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) {
  HdBasisCurves::UpdateRenderTag(delegate, param);
  shape_.set_render_tag(GetRenderTag(), *static_cast<RenderParam*>(param));
}

void Curves::Finalize(HdRenderParam* param) { static_cast<RenderParam*>(param)->forget_shape(shape_); }

void Curves::_InitRepr(const TfToken& name, HdDirtyBits*) {
  if (std::none_of(_reprs.begin(), _reprs.end(), _ReprComparator(name)))
    _reprs.emplace_back(name, HdReprSharedPtr());
}

}  // namespace msbvh::hydra
