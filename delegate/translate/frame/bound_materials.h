// A frame's materials by their paths, each handed down once, when the first shape asks for it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/frame/frame_input.h"
#include "delegate/translate/look/texture_source.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {

class BoundMaterials {
 public:
  // Borrows all of them.
  BoundMaterials(const std::vector<FrameMaterial>& materials, const TextureSource& textures,
                 Translator& translator);

  // Sets the materials of a mesh and of its faces, and leaves of its named primvars those that they read.
  void bind(const FrameShape& shape, MeshInput& mesh, std::vector<int>& face_materials);
  // What networks have to say.
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  struct Bound {
    std::optional<std::uint32_t> number{};  // none: displayColor shows
    std::vector<std::string> needed_primvars{};
  };

  const Bound& bound(const std::string& path);
  Bound hand_down(const ShaderNetwork& network);

  std::map<std::string, const ShaderNetwork*> networks_;
  std::map<std::string, Bound> bound_;
  const TextureSource& textures_;
  Translator& translator_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace msbvh::translate
