// Materials: their networks as plain data. What these mean is decided in delegate/translate/look.
#pragma once

#include <pxr/imaging/hd/material.h>

#include "delegate/hydra/api_version.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::hydra {

class Material : public HdMaterial {
 public:
  explicit Material(const SdfPath& path) : HdMaterial(path) {}

  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) override;
  void Finalize(HdRenderParam* param) override;
  HdDirtyBits GetInitialDirtyBitsMask() const override { return HdMaterial::AllDirty; }

  // Without nodes where the host has given none.
  const translate::ShaderNetwork& network() const { return network_; }

 private:
  translate::ShaderNetwork network_;
};

}  // namespace msbvh::hydra
