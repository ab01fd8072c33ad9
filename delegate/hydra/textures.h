// Where the files of textures lie, and single channels for displacement by OpenUSD's own image readers (Hio).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "delegate/hydra/api_version.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::hydra {

class Textures : public translate::TextureSource {
 public:
  std::optional<TextureFile> locate(const std::string& file) const override;
  std::optional<translate::ColourImage> colours(const translate::Asset& texture,
                                                std::string_view colour_space) const override;
  std::optional<translate::ScalarImage> channel(const translate::Asset& texture,
                                                std::string_view colour_space,
                                                std::size_t channel) const override;
};

}  // namespace msbvh::hydra
