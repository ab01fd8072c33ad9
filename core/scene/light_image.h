// The image that a light shines with, and how likely each part of it is to be sampled.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace msbvh {

// How a place (u, v) of an image, u to the right and v down, both in [0, 1], stands for a place of a light.
// Of a dome it is a direction in the dome's space, +y up. All maps have +z in their middle.
enum class ImageMap : std::uint8_t {
  kRect,         // (0, 0) is the corner at +x and +y: upright, as the lit side sees it (UsdLuxRectLight)
  kLatlong,      // longitude pi to -pi to the right, latitude pi/2 to -pi/2 down; +x at pi/2 (OpenEXR's)
  kAngular,      // a disc: the angle to +z grows evenly from its middle to 180 degrees at its rim; -x right
  kMirroredBall  // a ball that mirrors, seen from +z from far away; +x right
};

// Linear, in the rendering space. Between the middles of texels it is bilinear; a latlong image goes round.
struct LightImage {
  std::string name;  // for messages
  ImageMap map = ImageMap::kLatlong;
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3f> texels;  // [height][width], the uppermost row first
  // Cumulative shares of what the light gives, over the rows, and over the texels of each: they end at 1. Of
  // a row that gives nothing, and of an image that does not, all alike.
  std::vector<float> rows;     // [height]
  std::vector<float> columns;  // [height][width]
  float mean = 0.0f;  // over the unit square, of the largest channel; of a dome times steradians, over 4 pi
};

// From texels to both. Negative texels count as 0 in the shares. Throws Error, naming the image, where sizes
// do not match or a texel is not finite.
std::shared_ptr<const LightImage> light_image(std::string name, ImageMap map, std::uint32_t width,
                                              std::uint32_t height, std::vector<Vec3f> texels);

// Steradians for each unit of the image's area at a place; of a rect 1, 0 beyond a disc's rim.
double image_solid_angle(ImageMap map, double u, double v);

}  // namespace msbvh
