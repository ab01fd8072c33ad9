#include "delegate/hydra/light_links.h"

#include <algorithm>
#include <pxr/imaging/hd/tokens.h>

namespace msbvh::hydra {

LightLinks::LightLinks(const std::vector<Light*>& lights) {
  for (const Light* light : lights) {
    for (const TfToken& name : {HdTokens->lightLink, HdTokens->shadowLink}) {
      const std::string category = light->link(name);
      if (!category.empty() && std::ranges::find(categories_, category) == categories_.end())
        categories_.push_back(category);
    }
  }
  groups_[std::vector<bool>(categories_.size(), true)] = 0;
}

void LightLinks::add(const Shape& shape, translate::FrameInput& frame) {
  if (categories_.empty()) return;
  std::vector<bool> key;
  for (const std::string& category : categories_)
    key.push_back(std::ranges::find(shape.categories(), category) != shape.categories().end());
  const auto next = std::uint32_t(groups_.size());
  frame.light_groups[shape.path().GetString()] = {groups_.try_emplace(key, next).first->second};
}

std::vector<std::uint8_t> LightLinks::held(const std::string& category) const {
  const auto found = std::ranges::find(categories_, category);
  if (found == categories_.end()) return {};
  std::vector<std::uint8_t> held(groups_.size());
  for (const auto& [key, group] : groups_) held[group] = key[std::size_t(found - categories_.begin())];
  return held;
}

void LightLinks::link(const Light& light, LightLook& look) const {
  look.lit_groups = held(light.link(HdTokens->lightLink));
  look.shadow_groups = held(light.link(HdTokens->shadowLink));
}

}  // namespace msbvh::hydra
