#include "core/scene/light_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.h"

namespace msbvh {
namespace {

constexpr double kPi = std::numbers::pi;

void check(const LightImage& image) {
  const std::size_t expected = std::size_t(image.width) * image.height;
  if (expected == 0 || image.texels.size() != expected) {
    throw Error(image.name + ": found " + std::to_string(image.texels.size()) + " texels of " +
                std::to_string(image.width) + " x " + std::to_string(image.height) +
                "; expected one at least, and as many as width times height");
  }
  const auto bad = std::ranges::find_if(image.texels, [](const Vec3f& texel) { return !is_finite(texel); });
  if (bad != image.texels.end()) {
    throw Error(image.name + ": found NaN or infinity in texel " +
                std::to_string(bad - image.texels.begin()) + "; expected finite colours");
  }
}

// Of a texel itself, clamped at the edges; a latlong image goes round.
double brightness(const LightImage& image, std::int64_t x, std::int64_t y) {
  const std::int64_t width = image.width, height = image.height;
  x = image.map == ImageMap::kLatlong ? (x + width) % width : std::clamp<std::int64_t>(x, 0, width - 1);
  y = std::clamp<std::int64_t>(y, 0, height - 1);
  const Vec3f& texel = image.texels[std::size_t(y * width + x)];
  return std::max({0.0, double(texel.x), double(texel.y), double(texel.z)});
}

// The mean over a texel's square of what is bilinear between the middles of texels: above 0 wherever that is.
double smoothed(const LightImage& image, std::int64_t x, std::int64_t y) {
  constexpr double kShare[] = {0.125, 0.75, 0.125};
  double sum = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx)
      sum += kShare[dx + 1] * kShare[dy + 1] * brightness(image, x + dx, y + dy);
  }
  return sum;
}

// The mean over a texel's square. A disc's rim may cross it: by points then, which see some of it where there
// is.
double solid_angle(const LightImage& image, std::uint32_t x, std::uint32_t y) {
  const double w = image.width, h = image.height;
  if (image.map == ImageMap::kRect) return 1.0;
  if (image.map == ImageMap::kLatlong)
    return 2.0 * kPi * h * (std::cos(kPi * y / h) - std::cos(kPi * (y + 1) / h));
  constexpr int kPoints = 4;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      sum += image_solid_angle(image.map, (x + (i + 0.5) / kPoints) / w, (y + (j + 0.5) / kPoints) / h);
    }
  }
  return sum / (kPoints * kPoints);
}

// Cumulative shares of weights that sum to more than 0; evenly where they do not.
double accumulate(const std::vector<double>& weights, float* shares) {
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  double before = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    before += weights[i];
    const double share = sum > 0.0 ? before / sum : double(i + 1) / double(weights.size());
    shares[i] = static_cast<float>(std::min(share, 1.0));
  }
  shares[weights.size() - 1] = 1.0f;
  return sum;
}

}  // namespace

double image_solid_angle(ImageMap map, double u, double v) {
  if (map == ImageMap::kRect) return 1.0;
  if (map == ImageMap::kLatlong) return 2.0 * kPi * kPi * std::sin(kPi * v);
  const double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0, r = std::sqrt(x * x + y * y);
  if (r > 1.0) return 0.0;
  if (map == ImageMap::kMirroredBall) return 16.0;
  return r > 0.0 ? 4.0 * kPi * std::sin(kPi * r) / r : 4.0 * kPi * kPi;
}

std::shared_ptr<const LightImage> light_image(std::string name, ImageMap map, std::uint32_t width,
                                              std::uint32_t height, std::vector<Vec3f> texels) {
  auto image = std::make_shared<LightImage>();
  image->name = std::move(name);
  image->map = map;
  image->width = width;
  image->height = height;
  image->texels = std::move(texels);
  check(*image);
  image->rows.resize(height);
  image->columns.resize(std::size_t(width) * height);
  std::vector<double> row(width), all(height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) row[x] = smoothed(*image, x, y) * solid_angle(*image, x, y);
    all[y] = accumulate(row, image->columns.data() + std::size_t(y) * width);
  }
  const double sum = accumulate(all, image->rows.data()) / (double(width) * height);
  image->mean = static_cast<float>(map == ImageMap::kRect ? sum : sum / (4.0 * kPi));
  return image;
}

}  // namespace msbvh
