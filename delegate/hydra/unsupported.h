// Prims of kinds that are not drawn, such as volumes: hosts keep them from a delegate that does not list
// their type, so that it would not hear of them.
#pragma once

#include <pxr/imaging/hd/sceneIndexObserver.h>

#include "delegate/hydra/api_version.h"

namespace msbvh::hydra {

class RenderParam;

// Names the first prim of each kind that could be seen and is not supported, once.
class UnsupportedPrims final : public HdSceneIndexObserver {
 public:
  UnsupportedPrims(RenderParam& param, TfTokenVector supported)
      : param_(param), supported_(std::move(supported)) {}

  void PrimsAdded(const HdSceneIndexBase&, const AddedPrimEntries& entries) override;
  void PrimsRemoved(const HdSceneIndexBase&, const RemovedPrimEntries&) override {}
  void PrimsDirtied(const HdSceneIndexBase&, const DirtiedPrimEntries&) override {}
  void PrimsRenamed(const HdSceneIndexBase&, const RenamedPrimEntries&) override {}

 private:
  RenderParam& param_;
  TfTokenVector supported_;
};

}  // namespace msbvh::hydra
