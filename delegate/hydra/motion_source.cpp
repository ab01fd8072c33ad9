#include "delegate/hydra/motion_source.h"

#include <algorithm>
#include <functional>
#include <pxr/imaging/hd/instancerTopologySchema.h>
#include <pxr/imaging/hd/primvarSchema.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/timeSampleArray.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/imaging/hd/xformSchema.h>

namespace msbvh::hydra {
namespace {

using translate::EvaluatedMotion;
using translate::Matrix4d;
using translate::SampledMotion;
using translate::Turns;

constexpr unsigned kUsualSamples = 8;

std::vector<double> times01(const std::vector<float>& offsets, const Shutter& shutter) {
  std::vector<double> result;
  for (const float offset : offsets) result.push_back(shutter.time01(double(offset)));
  return result;
}

MotionPointer identity() { return SampledMotion::still(matrix_of(GfMatrix4d(1.0))); }

// Asks a data source at the times that the sampler wants.
MotionPointer evaluated(const HdSampledDataSourceHandle& source, std::size_t count, const Shutter& shutter,
                        const std::function<std::vector<Matrix4d>(const VtValue&)>& matrices) {
  const std::vector<float> offsets = contributing_offsets(*source, shutter);
  const auto evaluate = [source, shutter, matrices](double time01) {
    return matrices(source->GetValue(float(shutter.frames_at(time01))));
  };
  const bool still = offsets.size() < 2;
  return std::make_shared<EvaluatedMotion>(count, still, times01(offsets, shutter), evaluate,
                                           still ? Turns() : translate::uniform_turns(kAssumedTurns));
}

std::vector<Matrix4d> one_matrix(const VtValue& value) {
  if (!value.IsHolding<GfMatrix4d>()) return {};
  return {matrix_of(value.UncheckedGet<GfMatrix4d>())};
}

std::vector<Matrix4d> every_matrix(const VtValue& value) {
  std::vector<Matrix4d> result;
  if (!value.IsHolding<VtMatrix4dArray>()) return result;
  for (const GfMatrix4d& matrix : value.UncheckedGet<VtMatrix4dArray>()) result.push_back(matrix_of(matrix));
  return result;
}

MotionPointer from_samples(const HdTimeSampleArray<GfMatrix4d, kUsualSamples>& samples,
                           const Shutter& shutter) {
  if (samples.count == 0) return identity();
  std::vector<double> times;
  std::vector<Matrix4d> matrices;
  for (std::size_t i = 0; i < samples.count; ++i) {
    const double time01 = shutter.time01(double(samples.times[i]));
    if (!times.empty() && !(time01 > times.back())) continue;
    times.push_back(time01);
    matrices.push_back(matrix_of(samples.values[i]));
  }
  return std::make_shared<SampledMotion>(times, matrices);
}

// Of a scene index prim; null where that has no transform.
MotionPointer from_scene_index(const HdContainerDataSourceHandle& prim, const Shutter& shutter) {
  const HdMatrixDataSourceHandle matrix = HdXformSchema::GetFromParent(prim).GetMatrix();
  return matrix ? evaluated(matrix, 1, shutter, one_matrix) : nullptr;
}

}  // namespace

Matrix4d matrix_of(const GfMatrix4d& matrix) {
  Matrix4d result;
  std::copy_n(matrix.data(), result.size(), result.begin());
  return result;
}

MotionPointer transform_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  if (const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path)) {
    const MotionPointer found = from_scene_index(prim, shutter);
    return found ? found : identity();
  }
  HdTimeSampleArray<GfMatrix4d, kUsualSamples> samples;
  delegate.SampleTransform(path, float(shutter.open_frames), float(shutter.close_frames), &samples);
  return from_samples(samples, shutter);
}

MotionPointer instancer_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  if (const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path)) {
    const MotionPointer found = from_scene_index(prim, shutter);
    return found ? found : identity();
  }
  HdTimeSampleArray<GfMatrix4d, kUsualSamples> samples;
  delegate.SampleInstancerTransform(path, float(shutter.open_frames), float(shutter.close_frames), &samples);
  return from_samples(samples, shutter);
}

MotionPointer instance_matrices(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  const TfToken& name = HdInstancerTokens->instanceTransforms;
  if (const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path)) {
    HdPrimvarSchema primvar = HdPrimvarsSchema::GetFromParent(prim).GetPrimvar(name);
    const HdSampledDataSourceHandle source = primvar ? primvar.GetPrimvarValue() : nullptr;
    const std::size_t count = source ? every_matrix(source->GetValue(0.0f)).size() : 0;
    return count > 0 ? evaluated(source, count, shutter, every_matrix) : nullptr;
  }
  const TimedValues samples = timed_primvar(delegate, path, name, shutter, false);
  const std::size_t count = every_matrix(samples.at_frame).size();
  std::vector<double> times;
  std::vector<Matrix4d> matrices;
  for (std::size_t i = 0; count > 0 && i < samples.values.size(); ++i) {
    std::vector<Matrix4d> found = every_matrix(samples.values[i]);
    if (found.size() < count) continue;
    times.push_back(shutter.time01(double(samples.offsets[i])));
    matrices.insert(matrices.end(), found.begin(), found.begin() + std::ptrdiff_t(count));
  }
  return times.empty() ? nullptr : std::make_shared<SampledMotion>(times, matrices, count);
}

}  // namespace msbvh::hydra
