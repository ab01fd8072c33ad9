// Small scenes with much noise in some of their pixels and none in others.
#pragma once

#include "tests/render/pictures.h"

namespace msbvh::pictures {

// A floor under a dome with a cube over it that shades and reflects; nothing on the left.
inline Scene cube_over_floor(std::uint32_t width, std::uint32_t height) {
  Scene scene;
  scene.camera = pixel_camera(width, height);
  scene.lights = {dome({1.0f, 0.8f, 0.5f})};
  Mesh floor = polygon({rectangle(0.25f * float(width), 0, float(width), float(height))});
  floor.display_color.values = {{0.7f, 0.5f, 0.9f}};
  add(scene, floor);
  add(scene,
      baked(cube(), {{{4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {0.6f * float(width), 0.5f * float(height), 6.0f}}}));
  return scene;
}

// In each pixel a stripe of its width's share that shines by 1 towards the camera; else nothing.
inline Scene stripes(std::uint32_t width, std::uint32_t height, float share) {
  Scene scene;
  scene.camera = pixel_camera(width, height);
  scene.lights = {camera_light()};
  for (std::uint32_t x = 0; x < width; ++x) {
    Mesh stripe = polygon({rectangle(float(x) + 0.3f, 0, float(x) + 0.3f + share, float(height))});
    stripe.display_color.values = {{1, 1, 1}};
    add(scene, stripe);
  }
  return scene;
}

inline const AovImage& layer_of(const Image& image, Aov aov) {
  return *std::ranges::find(image.aovs, aov, &AovImage::aov);
}

}  // namespace msbvh::pictures
