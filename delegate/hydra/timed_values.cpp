#include "delegate/hydra/timed_values.h"

#include <algorithm>
#include <pxr/imaging/hd/extComputationUtils.h>
#include <pxr/imaging/hd/primvarSchema.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/sceneIndex.h>
#include <pxr/imaging/hd/timeSampleArray.h>

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

TimedValues from_schema(HdPrimvarSchema primvar, const Shutter& shutter, bool indexed) {
  const HdIntArrayDataSourceHandle indices = indexed ? primvar.GetIndices() : nullptr;
  const HdSampledDataSourceHandle source =
      indices ? primvar.GetIndexedPrimvarValue() : primvar.GetPrimvarValue();
  TimedValues result = timed_values(source, shutter);
  if (!indices) return result;
  for (const float offset : result.offsets) result.indices.push_back(indices->GetTypedValue(offset));
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
    if (!samples.values[i].IsEmpty()) result.indices.push_back(samples.indices[i]);
  }
  result.at_frame = delegate.GetIndexedPrimvar(path, name, &result.indices_at_frame);
  const auto none = [](const VtIntArray& each) { return each.empty(); };
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
  return result;
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
  HdExtComputationUtils::SampleComputedPrimvarValues<kMostComputed>(
      wanted, &delegate, float(shutter.open_frames), float(shutter.close_frames), kMostComputed, &store);
  const auto found = store.find(name);
  if (found == store.end() || found->second.count == 0) return {};
  TimedValues result = from_samples(found->second);
  if (!result.empty()) result.at_frame = found->second.Resample(0.0f);
  return result;
}

}  // namespace msbvh::hydra
