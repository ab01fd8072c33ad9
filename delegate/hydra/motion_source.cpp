#include "delegate/hydra/motion_source.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <pxr/base/gf/quatd.h>
#include <pxr/imaging/hd/dataSourceLegacyPrim.h>
#include <pxr/imaging/hd/instancerTopologySchema.h>
#include <pxr/imaging/hd/primvarSchema.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/sceneIndex.h>
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

// Whether a prim comes from a scene delegate: its data sources know the frame and some samples, and what they
// say of other times is a blend of matrices, which turns nothing.
bool is_delegates(const HdContainerDataSourceHandle& prim) {
  return prim->Get(HdSceneIndexEmulationTokens->sceneDelegate) != nullptr;
}

// Between two matrices: what they turn by along the sphere, the rest in lines. As the ops of a stage do, with
// a turn about the object's own origin.
GfMatrix4d between(double share, const GfMatrix4d& a, const GfMatrix4d& b) {
  GfMatrix4d turn_a = a, turn_b = b;
  for (GfMatrix4d* turn : {&turn_a, &turn_b}) {
    turn->SetTranslateOnly(GfVec3d(0.0));
    if (!turn->Orthonormalize(false)) return a * (1.0 - share) + b * share;
  }
  if (turn_a.GetDeterminant() * turn_b.GetDeterminant() < 0.0) return a * (1.0 - share) + b * share;
  const GfMatrix4d turned = turn_a.GetTranspose() * turn_b;  // from the one to the other
  const GfQuatd quat = GfSlerp(share, GfQuatd(1.0), turned.ExtractRotationQuat());
  GfMatrix4d linear_a = a, linear_b = b;
  linear_a.SetTranslateOnly(GfVec3d(0.0));
  linear_b.SetTranslateOnly(GfVec3d(0.0));
  const GfMatrix4d stretch =
      linear_a * turn_a.GetTranspose() * (1.0 - share) + linear_b * turn_b.GetTranspose() * share;
  GfMatrix4d rotation(1.0);
  rotation.SetRotate(quat);
  GfMatrix4d result = stretch * turn_a * rotation;
  result.SetTranslateOnly(a.ExtractTranslation() * (1.0 - share) + b.ExtractTranslation() * share);
  return result;
}

// Of a scene delegate's prim: the samples and the frame, and turns between them.
MotionPointer interpolated(const HdSampledDataSourceHandle& source, std::size_t count, const Shutter& shutter,
                           const std::function<std::vector<GfMatrix4d>(const VtValue&)>& matrices) {
  std::vector<float> offsets = contributing_offsets(*source, shutter);
  const bool still = offsets.size() < 2;
  if (still || (offsets.front() < 0.0f && offsets.back() > 0.0f)) offsets.push_back(0.0f);
  std::sort(offsets.begin(), offsets.end());
  offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
  std::vector<double> times;
  std::vector<std::vector<GfMatrix4d>> samples;
  for (const float offset : still ? std::vector{0.0f} : offsets) {
    times.push_back(still ? 0.0 : shutter.time01(double(offset)));
    samples.push_back(matrices(source->GetValue(offset)));
    samples.back().resize(count, GfMatrix4d(1.0));
  }
  const auto evaluate = [times, samples, count](double time01) {
    const auto after = std::upper_bound(times.begin(), times.end(), time01) - times.begin();
    const std::size_t last = std::min(std::size_t(after), times.size() - 1);
    const std::size_t first = after == 0 ? 0 : std::size_t(after) - 1;
    const double way = times[last] - times[first];
    const double share = way > 0.0 ? (time01 - times[first]) / way : 0.0;
    std::vector<Matrix4d> result;
    for (std::size_t i = 0; i < count; ++i)
      result.push_back(matrix_of(between(share, samples[first][i], samples[last][i])));
    return result;
  };
  return std::make_shared<EvaluatedMotion>(count, still, times, evaluate,
                                           still ? Turns() : translate::uniform_turns(kAssumedTurns));
}

std::vector<GfMatrix4d> one_host_matrix(const VtValue& value) {
  if (!value.IsHolding<GfMatrix4d>()) return {};
  return {value.UncheckedGet<GfMatrix4d>()};
}

std::vector<GfMatrix4d> every_host_matrix(const VtValue& value) {
  if (!value.IsHolding<VtMatrix4dArray>()) return {};
  const auto& all = value.UncheckedGet<VtMatrix4dArray>();
  return {all.cbegin(), all.cend()};
}

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

bool same(const Matrix4d& a, const Matrix4d& b) {
  constexpr double kRounding = 1e-9;
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
    return std::abs(x - y) <= kRounding * std::max({1.0, std::abs(x), std::abs(y)});
  });
}

// Of native instances: UsdImaging hands their matrices over as they are at the frame alone, but the prims
// where they stand have transforms that are sampled. Null where there are no such prims, where they stand
// elsewhere at the frame, and where none of them moves.
MotionPointer from_locations(const HdSceneIndexBaseRefPtr& scene,
                             const HdContainerDataSourceHandle& instancer,
                             const std::vector<Matrix4d>& at_frame, const Shutter& shutter) {
  const HdPathArrayDataSourceHandle locations =
      HdInstancerTopologySchema::GetFromParent(instancer).GetInstanceLocations();
  if (!locations || !shutter.moving()) return nullptr;
  const VtArray<SdfPath> paths = locations->GetTypedValue(0.0f);
  if (paths.size() != at_frame.size()) return nullptr;
  std::vector<HdMatrixDataSourceHandle> sources;
  std::vector<float> offsets;
  for (const SdfPath& path : paths) {
    const HdMatrixDataSourceHandle source =
        HdXformSchema::GetFromParent(scene->GetPrim(path).dataSource).GetMatrix();
    if (!source || !same(matrix_of(source->GetTypedValue(0.0f)), at_frame[sources.size()])) return nullptr;
    const std::vector<float> own = contributing_offsets(*source, shutter);
    if (own.size() > 1) offsets.insert(offsets.end(), own.begin(), own.end());
    sources.push_back(source);
  }
  if (offsets.empty()) return nullptr;
  std::sort(offsets.begin(), offsets.end());
  offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
  const auto evaluate = [sources, shutter](double time01) {
    std::vector<Matrix4d> matrices;
    for (const HdMatrixDataSourceHandle& source : sources)
      matrices.push_back(matrix_of(source->GetTypedValue(float(shutter.frames_at(time01)))));
    return matrices;
  };
  return std::make_shared<EvaluatedMotion>(sources.size(), false, times01(offsets, shutter), evaluate,
                                           translate::uniform_turns(kAssumedTurns));
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
  if (matrix && is_delegates(prim)) return interpolated(matrix, 1, shutter, one_host_matrix);
  return matrix ? evaluated(matrix, 1, shutter, one_matrix) : nullptr;
}

// `sample` asks a host without scene indices.
template <typename Sample>
MotionPointer motion_of(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter,
                        const Sample& sample) {
  if (const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path)) {
    const MotionPointer found = from_scene_index(prim, shutter);
    return found ? found : identity();
  }
  HdTimeSampleArray<GfMatrix4d, kUsualSamples> samples;
  sample(float(shutter.open_frames), float(shutter.close_frames), &samples);
  return from_samples(samples, shutter);
}

}  // namespace

Matrix4d matrix_of(const GfMatrix4d& matrix) {
  Matrix4d result;
  std::copy_n(matrix.data(), result.size(), result.begin());
  return result;
}

MotionPointer transform_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  return motion_of(delegate, path, shutter, [&](float open, float close, auto* samples) {
    delegate.SampleTransform(path, open, close, samples);
  });
}

MotionPointer instancer_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  return motion_of(delegate, path, shutter, [&](float open, float close, auto* samples) {
    delegate.SampleInstancerTransform(path, open, close, samples);
  });
}

MotionPointer instance_matrices(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  const TfToken& name = HdInstancerTokens->instanceTransforms;
  if (const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path)) {
    HdPrimvarSchema primvar = HdPrimvarsSchema::GetFromParent(prim).GetPrimvar(name);
    const HdSampledDataSourceHandle source = primvar ? primvar.GetPrimvarValue() : nullptr;
    const std::vector<Matrix4d> at_frame =
        source ? every_matrix(source->GetValue(0.0f)) : std::vector<Matrix4d>();
    const std::size_t count = at_frame.size();
    const HdSceneIndexBaseRefPtr scene = delegate.GetRenderIndex().GetTerminalSceneIndex();
    if (const MotionPointer found = from_locations(scene, prim, at_frame, shutter)) return found;
    if (count > 0 && is_delegates(prim)) return interpolated(source, count, shutter, every_host_matrix);
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
