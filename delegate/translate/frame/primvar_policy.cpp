#include "delegate/translate/frame/primvar_policy.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

constexpr double kDefaultWidth = 1.0;

bool finite(float value) { return std::isfinite(value); }
bool finite(const Vec3f& value) { return is_finite(value); }

template <typename T>
bool all_finite(std::span<const T> values) {
  return std::ranges::all_of(values, [](const T& value) { return finite(value); });
}

}  // namespace

template <typename T>
void settle_samples(PrimvarInput<T>& primvar, const std::string& attribute, PrimLog& log) {
  std::vector<PrimvarSample<T>>& samples = primvar.samples;
  const std::span<const T> own = primvar.values;
  const auto same = [&](const PrimvarSample<T>& sample) { return std::ranges::equal(sample.values, own); };
  const auto as_many = [&](const PrimvarSample<T>& sample) { return sample.values.size() == own.size(); };
  const auto sound = [](const PrimvarSample<T>& sample) { return all_finite(sample.values); };
  if (std::ranges::all_of(samples, same) || !all_finite(own)) {
    samples.clear();
  } else if (!std::ranges::all_of(samples, as_many)) {
    log.warn(attribute,
             message("the number of values changes within the shutter; held the frame's ", own.size()));
    samples.clear();
  } else if (!std::ranges::all_of(samples, sound)) {
    log.warn(attribute, "found a value within the shutter that is not finite; held the frame's values");
    samples.clear();
  }
}

template void settle_samples(PrimvarInput<float>&, const std::string&, PrimLog&);
template void settle_samples(PrimvarInput<Vec3f>&, const std::string&, PrimLog&);

double largest_width(const PrimvarInput<float>& widths) {
  if (widths.values.empty() && widths.samples.empty()) return kDefaultWidth;
  float most = 0.0f;
  const auto add = [&](std::span<const float> values) {
    for (const float width : values) {
      if (std::isfinite(width)) most = std::max(most, width);
    }
  };
  add(widths.values);
  for (const PrimvarSample<float>& sample : widths.samples) add(sample.values);
  return most;
}

}  // namespace msbvh::translate
