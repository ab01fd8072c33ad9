// The steps of Sync, InitRepr and Finalize that HdMesh, HdBasisCurves and HdPoints share. A template, since
// Hydra keeps their helpers in protected members of HdRprim.
#pragma once

#include <optional>
#include <pxr/imaging/hd/changeTracker.h>
#include <pxr/imaging/hd/instancer.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/repr.h>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/shape.h"

namespace msbvh::hydra {

// `update_instancer`: HdRprim::_UpdateInstancer, which is protected.
template <typename Rprim, typename UpdateInstancer>
void sync_shape(Rprim& rprim, Shape& shape, HdSceneDelegate& delegate, RenderParam& param, HdDirtyBits& bits,
                const UpdateInstancer& update_instancer) {
  const SdfPath& path = rprim.GetId();
  update_instancer();
  HdInstancer::_SyncInstancerAndParents(delegate.GetRenderIndex(), rprim.GetInstancerId());
  if (bits & HdChangeTracker::DirtyMaterialId) rprim.SetMaterialId(delegate.GetMaterialId(path));
  const bool visible = bits & HdChangeTracker::DirtyVisibility ? delegate.GetVisible(path) : shape.visible();
  shape.set_links(rprim.GetInstancerId(), rprim.GetMaterialId(), visible);
  shape.set_render_tag(rprim.GetRenderTag(), param);
  shape.sync(delegate, bits, rprim.GetPrimId());
  param.note_shape(shape, bits);
  if (const std::optional<Shutter> shutter = param.last_shutter()) shape.pull(*shutter);
  bits &= ~HdChangeTracker::AllSceneDirtyBits;
}

}  // namespace msbvh::hydra
