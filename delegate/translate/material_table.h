// The materials of a scene as they are handed down: textures and names of primvars that several of them read
// are kept once.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/surface_look.h"

namespace msbvh::translate {

class MaterialTable {
 public:
  // Into the scene, which is always the same one. A material with a number that is not finite keeps its place
  // but becomes the default one, with a warning. Throws Error where `look` reads what it does not list.
  std::uint32_t add(SurfaceLook look, Scene& scene, PrimLog& log);

  // A primvar that is read of whatever has it: for the AOV st.
  void keep(const std::string& name, Scene& scene);
  std::span<const PrimvarName> kept() const { return kept_; }

  // What a material reads, by increasing names; of one that there is not, nothing.
  std::span<const PrimvarName> reads(std::uint32_t material) const;
  // None: no material reads one of that name.
  PrimvarName find(const std::string& primvar) const;

 private:
  TextureId texture(ImageTexture image, Scene& scene);
  PrimvarName primvar(const std::string& name, Scene& scene);

  std::map<std::string, std::vector<TextureId>> textures_;  // by their first file
  std::map<std::string, PrimvarName> primvars_;
  std::vector<std::vector<PrimvarName>> reads_;  // by material
  std::vector<PrimvarName> kept_;
};

}  // namespace msbvh::translate
