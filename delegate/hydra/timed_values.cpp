#include "delegate/hydra/timed_values.h"

#include <algorithm>
#include <memory>
#include <pxr/imaging/hd/extComputationUtils.h>
#include <pxr/imaging/hd/primvarSchema.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/sceneIndex.h>
#include <pxr/imaging/hd/timeSampleArray.h>
#include <pxr/imaging/hd/visibilitySchema.h>
#include <span>

namespace msbvh::hydra {
namespace {

constexpr unsigned kUsualSamples = 8;
// Of what a skeleton poses: a pose costs as much as all points.
constexpr unsigned kMostComputed = 17;

template <typename Samples>
TimedValues from_samples(const Samples& samples) {
  TimedValues result;
  for (std::size_t i = 0; i < samples.count; ++i) {
    if (samples.values[i].IsEmpty()) continue;
    result.offsets.push_back(samples.times[i]);
    result.values.push_back(samples.values[i]);
  }
  result.varies = result.values.size() > 1;
  return result;
}

// A held stage, by the first neighbours that differ and could be interpolated. Samples of arrays are where
// they say, so one look between them is enough.
bool is_held(HdSampledDataSource& source, const TimedValues& found) {
  for (std::size_t i = 1; i < found.values.size(); ++i) {
    const VtValue &before = found.values[i - 1], &after = found.values[i];
    if (before == after || before.GetArraySize() != after.GetArraySize()) continue;
    return source.GetValue(0.5f * (found.offsets[i - 1] + found.offsets[i])) == before;
  }
  return false;
}

TimedValues from_schema(HdPrimvarSchema primvar, const Shutter& shutter, bool indexed) {
  const HdIntArrayDataSourceHandle indices = indexed ? primvar.GetIndices() : nullptr;
  const HdSampledDataSourceHandle source =
      indices ? primvar.GetIndexedPrimvarValue() : primvar.GetPrimvarValue();
  TimedValues result = timed_values(source, shutter);
  if (!indices) return result;
  for (const float offset : contributing_offsets(*indices, shutter))
    result.indices.emplace_back(offset, indices->GetTypedValue(offset));
  result.indices_at_frame = indices->GetTypedValue(0.0f);
  return result;
}

TimedValues from_delegate(HdSceneDelegate& delegate, const SdfPath& path, const TfToken& name,
                          const Shutter& shutter, bool indexed) {
  const auto open = float(shutter.open_frames), close = float(shutter.close_frames);
  if (!indexed) {
    HdTimeSampleArray<VtValue, kUsualSamples> samples;
    delegate.SamplePrimvar(path, name, open, close, &samples);
    TimedValues result = from_samples(samples);
    result.at_frame = delegate.Get(path, name);
    return result;
  }
  HdIndexedTimeSampleArray<VtValue, kUsualSamples> samples;
  delegate.SampleIndexedPrimvar(path, name, open, close, &samples);
  TimedValues result = from_samples(samples);
  for (std::size_t i = 0; i < samples.count; ++i) {
    if (!samples.values[i].IsEmpty()) result.indices.emplace_back(samples.times[i], samples.indices[i]);
  }
  result.at_frame = delegate.GetIndexedPrimvar(path, name, &result.indices_at_frame);
  const auto none = [](const auto& each) { return each.second.empty(); };
  if (std::all_of(result.indices.begin(), result.indices.end(), none)) result.indices.clear();
  return result;
}

}  // namespace

HdContainerDataSourceHandle scene_index_prim(HdSceneDelegate& delegate, const SdfPath& path) {
  const HdSceneIndexBaseRefPtr scene = delegate.GetRenderIndex().GetTerminalSceneIndex();
  return scene ? scene->GetPrim(path).dataSource : nullptr;
}

std::vector<float> contributing_offsets(HdSampledDataSource& source, const Shutter& shutter) {
  std::vector<float> offsets;
  if (!shutter.moving()) return offsets;
  const auto open = float(shutter.open_frames), close = float(shutter.close_frames);
  if (!source.GetContributingSampleTimesForInterval(open, close, &offsets)) offsets.clear();
  std::sort(offsets.begin(), offsets.end());
  offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
  return offsets;
}

TimedValues timed_values(const HdSampledDataSourceHandle& source, const Shutter& shutter) {
  TimedValues result;
  if (!source) return result;
  result.at_frame = source->GetValue(0.0f);
  std::vector<float> offsets = contributing_offsets(*source, shutter);
  result.varies = !offsets.empty();
  if (offsets.empty()) offsets = {0.0f};
  for (const float offset : offsets) {
    VtValue value = source->GetValue(offset);
    if (value.IsEmpty()) continue;
    result.offsets.push_back(offset);
    result.values.push_back(std::move(value));
  }
  result.held = is_held(*source, result);
  return result;
}

TimedInts timed_ints(const HdIntArrayDataSourceHandle& source, const Shutter& shutter) {
  TimedInts result;
  if (!source) return result;
  for (const float offset : contributing_offsets(*source, shutter)) {
    const VtIntArray values = source->GetTypedValue(offset);
    if (result.empty() || values != result.back().second)
      result.emplace_back(shutter.time01(double(offset)), values);
  }
  if (result.size() < 2) result.clear();
  return result;
}

bool changes_within(const HdIntArrayDataSourceHandle& source, const Shutter& shutter) {
  const TimedInts found = timed_ints(source, shutter);
  return std::any_of(found.begin(), found.end(),
                     [](const auto& each) { return each.first > 0.0 && each.first < 1.0; });
}

translate::HeldIndices held_indices(const TimedInts& values) {
  translate::HeldIndices held;
  for (const auto& [time01, array] : values)
    held.samples.emplace_back(time01, std::span(array.cdata(), array.size()));
  return held;
}

translate::Visibility timed_visibility(HdSceneDelegate& delegate, const SdfPath& path,
                                       const Shutter& shutter) {
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path);
  const HdBoolDataSourceHandle source =
      prim ? HdVisibilitySchema::GetFromParent(prim).GetVisibility() : nullptr;
  if (!source) return std::nullopt;
  const std::vector<float> offsets = contributing_offsets(*source, shutter);
  if (offsets.size() < 2) return std::nullopt;
  std::vector<double> begins01{0.0};
  for (const float offset : offsets) {
    const double time01 = shutter.time01(double(offset));
    if (time01 > 0.0 && time01 < 1.0) begins01.push_back(time01);
  }
  const auto shown = std::make_unique<bool[]>(begins01.size());  // a span of bools needs an array of them
  for (std::size_t i = 0; i < begins01.size(); ++i)
    shown[i] = source->GetTypedValue(float(shutter.frames_at(begins01[i])));
  return translate::visible_intervals(begins01, {shown.get(), begins01.size()});
}

TimedValues timed_primvar(HdSceneDelegate& delegate, const SdfPath& path, const TfToken& name,
                          const Shutter& shutter, bool indexed) {
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path);
  if (!prim) return from_delegate(delegate, path, name, shutter, indexed);
  HdPrimvarSchema primvar = HdPrimvarsSchema::GetFromParent(prim).GetPrimvar(name);
  return primvar ? from_schema(primvar, shutter, indexed) : TimedValues{};
}

TimedValues timed_computation(HdSceneDelegate& delegate, const SdfPath& path, const TfToken& name,
                              const Shutter& shutter) {
  HdExtComputationPrimvarDescriptorVector wanted;
  for (const HdInterpolation interpolation : {HdInterpolationVertex, HdInterpolationVarying}) {
    for (const auto& descriptor : delegate.GetExtComputationPrimvarDescriptors(path, interpolation)) {
      if (descriptor.name == name) wanted.push_back(descriptor);
    }
  }
  if (wanted.empty()) return {};
  HdExtComputationUtils::SampledValueStore<kMostComputed> store;
#if MSBVH_COMPUTES_OVER_INTERVAL
  HdExtComputationUtils::SampleComputedPrimvarValues<kMostComputed>(
      wanted, &delegate, float(shutter.open_frames), float(shutter.close_frames), kMostComputed, &store);
#else
  static_cast<void>(shutter);
  HdExtComputationUtils::SampleComputedPrimvarValues<kMostComputed>(wanted, &delegate, kMostComputed, &store);
#endif
  const auto found = store.find(name);
  if (found == store.end() || found->second.count == 0) return {};
  TimedValues result = from_samples(found->second);
  if (!result.empty()) result.at_frame = found->second.Resample(0.0f);
  return result;
}

}  // namespace msbvh::hydra
