#include "delegate/translate/frame/sample_sum.h"

#include <algorithm>

#include "core/base/error.h"

namespace msbvh::translate {
namespace {

bool is_mean(Aov aov) { return aov == Aov::kNeye || aov == Aov::kNormal || aov == Aov::kAlbedo; }

const AovImage* camera_depth(const Image& picture) {
  for (const AovImage& aov : picture.aovs) {
    if (aov.aov == Aov::kCameraDepth) return &aov;
  }
  return nullptr;
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
    if (!is_mean(picture.aovs[a].aov)) continue;
    const std::vector<float>& values = picture.aovs[a].values;
    means_[a].resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) means_[a][i] += double(values[i]) * count;
  }
}

void SampleSum::take_nearest(const Image& picture) {
  if (samples_ == 0) {
    nearest_ = picture;
    nearest_.rgba.clear();
    return;
  }
  const bool any = std::ranges::any_of(picture.aovs, [](const AovImage& a) { return !is_mean(a.aov); });
  if (!any) return;
  const AovImage* depth = camera_depth(picture);
  const AovImage* known = camera_depth(nearest_);
  if (!depth) throw Error("depths and ids of samples: found no cameraDepth; expected it among the AOVs");
  const std::vector<float> before = known->values;
  for (std::size_t a = 0; a < picture.aovs.size(); ++a) {
    const AovImage& from = picture.aovs[a];
    if (is_mean(from.aov)) continue;
    AovImage& to = nearest_.aovs[a];
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!(depth->values[i] < before[i])) continue;
      form_of(from.aov).is_id ? void(to.ids[i] = from.ids[i]) : void(to.values[i] = from.values[i]);
    }
  }
}

Image SampleSum::picture() const {
  Image whole = nearest_;
  whole.rgba.resize(rgba_.size());
  for (std::size_t i = 0; i < rgba_.size(); ++i) whole.rgba[i] = float(rgba_[i] / samples_);
  for (std::size_t a = 0; a < whole.aovs.size(); ++a) {
    for (std::size_t i = 0; i < means_[a].size(); ++i)
      whole.aovs[a].values[i] = float(means_[a][i] / samples_);
  }
  return whole;
}

std::vector<Aov> with_depth(std::vector<Aov> aovs) {
  const bool any = std::ranges::any_of(aovs, [](Aov aov) { return !is_mean(aov); });
  if (any && std::ranges::find(aovs, Aov::kCameraDepth) == aovs.end()) aovs.push_back(Aov::kCameraDepth);
  return aovs;
}

SampleRange next_samples(std::uint32_t done, std::uint32_t all) {
  const std::uint32_t left = all > done ? all - done : 0;
  return {done, std::min(left, std::clamp(done, 1u, kBlockSamples))};
}

}  // namespace msbvh::translate
