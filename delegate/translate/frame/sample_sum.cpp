#include "delegate/translate/frame/sample_sum.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace msbvh::translate {
namespace {

bool is_nearest(Aov aov) { return form_of(aov).merge == AovMerge::kNearest; }

// What a picture of `count` samples brings to a sum: means count by their samples, totals as they are, and
// errors by the variance of the sum of their samples.
double part_of_sum(AovMerge merge, double value, double count) {
  if (merge == AovMerge::kTotal) return value;
  return merge == AovMerge::kMean ? value * count : value * value * count * count;
}
double from_sum(AovMerge merge, double sum, double count) {
  if (merge == AovMerge::kTotal) return sum;
  return merge == AovMerge::kMean ? sum / count : std::sqrt(sum) / count;
}

const AovImage* camera_depth(const Image& picture) {
  for (const AovImage& aov : picture.aovs) {
    if (aov.aov == Aov::kCameraDepth) return &aov;
  }
  return nullptr;
}

void take_pixel(const AovImage& from, std::size_t pixel, AovImage& to) {
  if (form_of(from.aov).is_id) {
    to.ids[pixel] = from.ids[pixel];
    return;
  }
  const std::size_t numbers = form_of(from.aov).numbers;
  std::copy_n(&from.values[pixel * numbers], numbers, &to.values[pixel * numbers]);
}

bool same_layout(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height &&
         std::ranges::equal(a.aovs, b.aovs, {}, &AovImage::aov, &AovImage::aov);
}

}  // namespace

void SampleSum::add(const Image& picture, std::uint32_t count) {
  if (count == 0) return;
  if (samples_ > 0 && !same_layout(picture, nearest_))
    throw Error("pictures of samples: found another size or other AOVs; expected the same throughout");
  add_means(picture, count);
  take_nearest(picture);
  samples_ += count;
}

void SampleSum::add_means(const Image& picture, std::uint32_t count) {
  rgba_.resize(picture.rgba.size());
  for (std::size_t i = 0; i < rgba_.size(); ++i) rgba_[i] += double(picture.rgba[i]) * count;
  means_.resize(picture.aovs.size());
  for (std::size_t a = 0; a < means_.size(); ++a) {
    const AovMerge merge = form_of(picture.aovs[a].aov).merge;
    if (merge == AovMerge::kNearest) continue;
    if (merge == AovMerge::kCoverage)
      throw Error("pictures of samples: found a Cryptomatte; expected none, since its parts do not add up");
    const std::vector<float>& values = picture.aovs[a].values;
    means_[a].resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      means_[a][i] += part_of_sum(merge, double(values[i]), count);
  }
}

void SampleSum::take_nearest(const Image& picture) {
  if (samples_ == 0) {
    nearest_ = picture;
    nearest_.rgba.clear();
    return;
  }
  const bool any = std::ranges::any_of(picture.aovs, [](const AovImage& a) { return is_nearest(a.aov); });
  if (!any) return;
  const AovImage* depth = camera_depth(picture);
  const AovImage* known = camera_depth(nearest_);
  if (!depth) throw Error("depths and ids of samples: found no cameraDepth; expected it among the AOVs");
  const std::vector<float> before = known->values;
  for (std::size_t a = 0; a < picture.aovs.size(); ++a) {
    const AovImage& from = picture.aovs[a];
    if (!is_nearest(from.aov)) continue;
    AovImage& to = nearest_.aovs[a];
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!(depth->values[i] < before[i])) continue;
      take_pixel(from, i, to);
    }
  }
}

Image SampleSum::picture() const {
  Image whole = nearest_;
  whole.rgba.resize(rgba_.size());
  for (std::size_t i = 0; i < rgba_.size(); ++i) whole.rgba[i] = float(rgba_[i] / samples_);
  for (std::size_t a = 0; a < whole.aovs.size(); ++a) {
    for (std::size_t i = 0; i < means_[a].size(); ++i)
      whole.aovs[a].values[i] = float(from_sum(form_of(whole.aovs[a].aov).merge, means_[a][i], samples_));
  }
  return whole;
}

std::vector<Aov> with_depth(std::vector<Aov> aovs) {
  const bool any = std::ranges::any_of(aovs, is_nearest);
  if (any && std::ranges::find(aovs, Aov::kCameraDepth) == aovs.end()) aovs.push_back(Aov::kCameraDepth);
  return aovs;
}

SampleRange next_samples(std::uint32_t done, std::uint32_t all) {
  const std::uint32_t left = all > done ? all - done : 0;
  return {done, std::min(left, std::clamp(done, 1u, kBlockSamples))};
}

}  // namespace msbvh::translate
