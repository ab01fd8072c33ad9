// Textures by OpenUSD's own image readers (Hio): their means, and single channels for displacement, until the
// core evaluates textures itself.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "delegate/hydra/api_version.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::hydra {

// Remembers what it has read. For one thread.
class Textures : public translate::TextureSource {
 public:
  std::optional<translate::Rgba> mean(const translate::Asset& texture,
                                      std::string_view colour_space) const override;
  std::optional<translate::ColourImage> colours(const translate::Asset& texture,
                                                std::string_view colour_space) const override;
  std::optional<translate::ScalarImage> channel(const translate::Asset& texture,
                                                std::string_view colour_space,
                                                std::size_t channel) const override;

 private:
  mutable std::map<std::pair<std::string, std::string>, std::optional<translate::Rgba>> means_;
};

}  // namespace msbvh::hydra
