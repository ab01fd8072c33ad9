#include "core/shade/light/image.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/lerp.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// One of the steps of a cumulative sum, and where in it.
struct Step {
  std::uint32_t index;
  float within;  // in [0, 1]
  float share;
};

float share_of(std::span<const float> sums, std::uint32_t i) {
  return i > 0 ? sums[i] - sums[i - 1] : sums[0];
}

Step pick(std::span<const float> sums, float random) {
  const auto last = static_cast<std::ptrdiff_t>(sums.size()) - 1;
  const std::ptrdiff_t found = std::min(std::ranges::upper_bound(sums, random) - sums.begin(), last);
  const auto i = static_cast<std::uint32_t>(found);
  const float share = share_of(sums, i), before = i > 0 ? sums[i - 1] : 0.0f;
  return {i, share > 0.0f ? std::min((random - before) / share, 1.0f) : 0.5f, share};
}

std::span<const float> columns_of(const LightImage& image, std::uint32_t row) {
  return {image.columns.data() + std::size_t(row) * image.width, image.width};
}

std::uint32_t texel_of(float place, std::uint32_t size) {
  return static_cast<std::uint32_t>(std::clamp(static_cast<std::int64_t>(place * static_cast<float>(size)),
                                               std::int64_t(0), std::int64_t(size) - 1));
}

// Two neighbours, and how near the place is to the second.
struct Between {
  std::uint32_t first, second;
  float w;
};

Between between(float place, std::uint32_t size, bool round) {
  const float at = place * static_cast<float>(size) - 0.5f, floor = std::floor(at);
  const auto first = static_cast<std::int64_t>(floor), n = std::int64_t(size);
  const auto kept = [&](std::int64_t i) {
    return static_cast<std::uint32_t>(round ? ((i % n) + n) % n : std::clamp(i, std::int64_t(0), n - 1));
  };
  return {kept(first), kept(first + 1), at - floor};
}

}  // namespace

ImagePlace sample_image(const LightImage& image, Point2 random) {
  const Step row = pick(image.rows, random.y), column = pick(columns_of(image, row.index), random.x);
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  return {(static_cast<float>(column.index) + column.within) / width,
          (static_cast<float>(row.index) + row.within) / height, row.share * height * (column.share * width)};
}

float image_density(const LightImage& image, float u, float v) {
  const std::uint32_t row = texel_of(v, image.height), column = texel_of(u, image.width);
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  return share_of(image.rows, row) * height * (share_of(columns_of(image, row), column) * width);
}

Vec3f image_at(const LightImage& image, float u, float v) {
  const Between x = between(u, image.width, image.map == ImageMap::kLatlong);
  const Between y = between(v, image.height, false);
  const auto texel = [&](std::uint32_t column, std::uint32_t row) {
    return image.texels[std::size_t(row) * image.width + column];
  };
  const Vec3f upper = lerp(texel(x.first, y.first), texel(x.second, y.first), x.w);
  return lerp(upper, lerp(texel(x.first, y.second), texel(x.second, y.second), x.w), y.w);
}

Vec3f image_direction(ImageMap map, float u, float v) {
  if (map == ImageMap::kLatlong) {
    const float longitude = kPi * (1.0f - 2.0f * u), colatitude = kPi * v, s = std::sin(colatitude);
    return {s * std::sin(longitude), std::cos(colatitude), s * std::cos(longitude)};
  }
  const float x = 2.0f * u - 1.0f, y = 1.0f - 2.0f * v, r2 = x * x + y * y, r = std::sqrt(r2);
  if (r == 0.0f) return {0.0f, 0.0f, 1.0f};
  if (map == ImageMap::kMirroredBall) {
    const float scale = 2.0f * std::sqrt(std::max(0.0f, 1.0f - r2));
    return {x * scale, y * scale, 1.0f - 2.0f * r2};
  }
  const float scale = std::sin(kPi * r) / r;
  return {-x * scale, y * scale, std::cos(kPi * r)};
}

Point2 image_place(ImageMap map, const Vec3f& direction) {
  const Vec3f& d = direction;
  if (map == ImageMap::kLatlong) {
    return {0.5f - std::atan2(d.x, d.z) * (0.5f / kPi),
            std::acos(std::clamp(d.y, -1.0f, 1.0f)) * (1.0f / kPi)};
  }
  const float z = std::clamp(d.z, -1.0f, 1.0f), sine = std::sqrt(d.x * d.x + d.y * d.y);
  const float r = map == ImageMap::kMirroredBall ? std::sqrt(0.5f * (1.0f - z)) : std::acos(z) * (1.0f / kPi);
  if (sine == 0.0f) return {0.5f, 0.5f - 0.5f * r};
  const float x = (map == ImageMap::kMirroredBall ? d.x : -d.x) / sine * r, y = d.y / sine * r;
  return {0.5f + 0.5f * x, 0.5f - 0.5f * y};
}

}  // namespace msbvh
