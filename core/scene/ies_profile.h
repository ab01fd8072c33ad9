// How the light of a luminaire is spread over directions: photometric data of type C.
#pragma once

#include <memory>
#include <vector>

namespace msbvh {

// Luminous intensity by directions, linear between the angles that are given; 0 beyond the vertical ones.
struct IesProfile {
  std::vector<float> vertical;    // degrees from the light's -z axis, 0 to 180, increasing; two at least
  std::vector<float> horizontal;  // degrees about it, 0 to 360, increasing; goes round: two at least
  std::vector<float> candela;     // [horizontal][vertical]
  // The mean intensity over the sphere, or over the half of it where the vertical angles span no more than 90
  // degrees: what inputs:shaping:ies:normalize divides by.
  float power = 0.0f;
};

// As a light wears it.
struct IesShaping {
  std::shared_ptr<const IesProfile> profile;  // null: none
  // UsdLux's inputs:shaping:ies:angleScale: above 0 it stretches angles from -z, below 0 from +z, 0: neither.
  float angle_scale = 0.0f;
  bool normalize = false;
};

}  // namespace msbvh
