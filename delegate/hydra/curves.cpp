#include "delegate/hydra/curves.h"

#include <algorithm>
#include <pxr/imaging/hd/basisCurvesSchema.h>
#include <pxr/imaging/hd/basisCurvesTopologySchema.h>

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

}  // namespace msbvh::hydra
