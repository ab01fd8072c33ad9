// Light images by places and directions: what they give, and how they are sampled (core/scene/light_image.h).
#pragma once

#include "core/base/vec.h"
#include "core/scene/light_image.h"
#include "core/shade/point2.h"

namespace msbvh {

struct ImagePlace {
  float u, v;     // in [0, 1]
  float density;  // that sample_image() takes it, over the unit square
};

// By what each texel gives: rows first, then the texels of one.
ImagePlace sample_image(const LightImage& image, Point2 random);
float image_density(const LightImage& image, float u, float v);

Vec3f image_at(const LightImage& image, float u, float v);

// Unit, in the dome's space; of a disc's inside.
Vec3f image_direction(ImageMap map, float u, float v);
Point2 image_place(ImageMap map, const Vec3f& direction);

}  // namespace msbvh
