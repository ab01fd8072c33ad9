// Light linking by Hydra's categories: light groups of shapes, and what of them each light reaches.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "delegate/hydra/light.h"
#include "delegate/hydra/shape.h"
#include "delegate/translate/frame/frame_input.h"

namespace msbvh::hydra {

class LightLinks {
 public:
  explicit LightLinks(const std::vector<Light*>& lights);

  // Gives a shape its group. Instances have that of the shape that they show.
  void add(const Shape& shape, translate::FrameInput& frame);
  // After all shapes.
  void link(const Light& light, LightLook& look) const;

 private:
  std::vector<std::uint8_t> held(const std::string& category) const;

  std::vector<std::string> categories_;  // that some light's links ask for
  std::map<std::vector<bool>, std::uint32_t> groups_;
};

}  // namespace msbvh::hydra
