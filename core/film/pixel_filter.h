// How much light around a pixel's centre counts for it.
//
// Filters are sampled, not splatted: each sample's place is drawn from the filter of its own pixel, and all
// samples count alike (M. Ernst, M. Stamminger, G. Greiner, "Filter Importance Sampling", Symposium on
// Interactive Ray Tracing 2006). A pixel's samples are its own alone, so tiles and crops share none. None of
// these filters has negative lobes, which could not be sampled so.
#pragma once

#include <cstdint>

#include "core/film/piecewise_linear.h"
#include "core/shade/point2.h"

namespace msbvh {

enum class FilterShape : std::uint8_t {
  kBox,
  kTriangle,
  kGaussian,       // exp(-2 r^2), cut off at r = 1: half the width
  kBlackmanHarris  // four terms; F. Harris, "On the Use of Windows for Harmonic Analysis", Proc. IEEE 66,
                   // 1978
};

struct FilterName {
  FilterShape shape;
  const char* name;
  float width;  // that is usual
};
inline constexpr FilterName kFilters[] = {{FilterShape::kBox, "box", 1.0f},
                                          {FilterShape::kTriangle, "triangle", 2.0f},
                                          {FilterShape::kGaussian, "gaussian", 2.0f},
                                          {FilterShape::kBlackmanHarris, "blackman-harris", 3.0f}};

// Over the picture's sides filters reach half of this, which the view volume of a frame has room for.
inline constexpr float kMostFilterWidth = 4.0f;

struct PixelFilter {
  FilterShape shape = FilterShape::kBox;
  float width = 1.0f;  // pixels across, in x and in y; above 0, up to kMostFilterWidth

  constexpr bool is_pixel() const { return shape == FilterShape::kBox && width == 1.0f; }
};

// Along one axis, `r` in [-1, 1] from the centre to the filter's edge; its largest value is 1.
double filter_weight(FilterShape shape, double r);

// In pixels from the pixel's upper left corner: the pixel itself is [0, 1)^2.
struct PixelPlace {
  float x, y;
};

class FilterSampler {
 public:
  FilterSampler() = default;  // of the pixel itself
  explicit FilterSampler(const PixelFilter& filter);

  // From a point of the unit square to one of the filter.
  PixelPlace operator()(const Point2& p) const { return {along(p.x), along(p.y)}; }

 private:
  float along(float u) const {
    return offset_.empty() ? u : static_cast<float>(0.5 + offset_.sample(double(u)));
  }

  PiecewiseLinear offset_;  // from the centre, pixels; empty: the pixel itself, to the bit
};

}  // namespace msbvh
