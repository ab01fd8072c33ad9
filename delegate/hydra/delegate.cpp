#include "delegate/hydra/delegate.h"

#include <algorithm>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/extComputation.h>
#include <pxr/imaging/hd/tokens.h>
#include <sys/resource.h>

#include "delegate/hydra/camera.h"
#include "delegate/hydra/curves.h"
#include "delegate/hydra/implicit.h"
#include "delegate/hydra/instancer.h"
#include "delegate/hydra/light.h"
#include "delegate/hydra/material.h"
#include "delegate/hydra/mesh.h"
#include "delegate/hydra/points.h"
#include "delegate/hydra/render_buffer.h"
#include "delegate/hydra/render_pass.h"
#include "delegate/hydra/render_settings.h"
#include "delegate/hydra/settings.h"

namespace msbvh::hydra {
namespace {

// Bytes; the most that the process has had so far.
std::int64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t(usage.ru_maxrss) * 1024;
}

bool is_one_of(const TfTokenVector& types, const TfToken& type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

TfTokenVector supported_types(const Delegate& delegate) {
  TfTokenVector all = delegate.GetSupportedRprimTypes();
  const TfTokenVector& lights = Light::types();
  all.insert(all.end(), lights.begin(), lights.end());
  return all;
}

}  // namespace

Delegate::Delegate(const HdRenderSettingsMap& settings)
    : HdRenderDelegate(settings), unsupported_(param_, supported_types(*this)) {
  _PopulateDefaultSettings(setting_descriptors());
}

// Passes that outlive it render nothing more.
Delegate::~Delegate() { jobs_->stop(); }

const TfTokenVector& Delegate::GetSupportedRprimTypes() const {
  static const TfTokenVector types = [] {
    TfTokenVector all = implicit_types();
    all.insert(all.end(), {HdPrimTypeTokens->mesh, HdPrimTypeTokens->basisCurves, HdPrimTypeTokens->points});
    return all;
  }();
  return types;
}

const TfTokenVector& Delegate::GetSupportedSprimTypes() const {
  static const TfTokenVector types = [] {
    TfTokenVector all = Light::types();
    all.insert(all.end(),
               {HdPrimTypeTokens->camera, HdPrimTypeTokens->material, HdPrimTypeTokens->extComputation});
    return all;
  }();
  return types;
}

const TfTokenVector& Delegate::GetSupportedBprimTypes() const {
  static const TfTokenVector types{HdPrimTypeTokens->renderBuffer, HdPrimTypeTokens->renderSettings};
  return types;
}

HdRenderSettingDescriptorList Delegate::GetRenderSettingDescriptors() const { return setting_descriptors(); }

// percentDone, fractionDone, totalClockTime and peakMemory as husk reads them; the rest are ours.
VtDictionary Delegate::GetRenderStats() const {
  const translate::JobStatus status = jobs_->status();
  const RenderStatistics& found = status.statistics;
  const Edits edits = param_.edits();
  VtDictionary stats;
  stats["rendererName"] = std::string("MSBVH");
  stats["rendererStage"] = std::string(status.building    ? "building"
                                       : status.paused    ? "paused"
                                       : status.converged ? "done"
                                                          : "tracing");
  stats["percentDone"] = 100.0 * status.fraction;
  stats["fractionDone"] = status.fraction;
  stats["totalClockTime"] = status.seconds;
  stats["firstPictureSeconds"] = status.first_picture_seconds;
  stats["peakMemory"] = peak_memory();
  stats["cameraRays"] = std::int64_t(found.camera_rays);
  stats["rays"] = std::int64_t(found.rays.rays());
  stats[HdPerfTokens->numCompletedSamples.GetString()] = int(status.samples);
  stats["wantedSamples"] = int(status.wanted);
  stats["buildSeconds"] = found.build_seconds;
  stats["traceSeconds"] = found.trace_seconds;
  stats["treeBytes"] = std::int64_t(found.accel.total_bytes());
  stats["treesBuilt"] = std::int64_t(found.accel.built);
  stats["treesRefitted"] = std::int64_t(found.accel.refitted);
  stats["treesKept"] = std::int64_t(found.accel.kept);
  stats["scenes"] = std::int64_t(scenes_.load());
  stats["editedCameras"] = std::int64_t(edits.cameras);
  stats["editedTransforms"] = std::int64_t(edits.transforms);
  stats["editedPoints"] = std::int64_t(edits.points);
  stats["editedTopology"] = std::int64_t(edits.topology);
  stats["editedLooks"] = std::int64_t(edits.looks);
  stats["editedLights"] = std::int64_t(edits.lights);
  return stats;
}

bool Delegate::Pause() {
  jobs_->pause();
  return true;
}

bool Delegate::Resume() {
  jobs_->resume();
  return true;
}

bool Delegate::IsStopped() const { return jobs_->idle(); }

// Blocking takes the length of a tile, or of a step in building a tree.
bool Delegate::Stop(bool blocking) {
  jobs_->stop(blocking);
  return true;
}

bool Delegate::Restart() {
  jobs_->restart();
  return true;
}

HdRenderPassSharedPtr Delegate::CreateRenderPass(HdRenderIndex* index, const HdRprimCollection& collection) {
  return std::make_shared<RenderPass>(index, collection, *this);
}

HdInstancer* Delegate::CreateInstancer(HdSceneDelegate* delegate, const SdfPath& path) {
  return new Instancer(delegate, path);
}

void Delegate::DestroyInstancer(HdInstancer* instancer) { delete instancer; }

HdRprim* Delegate::CreateRprim(const TfToken& type, const SdfPath& path) {
  if (type == HdPrimTypeTokens->mesh) return new Mesh(path);
  if (type == HdPrimTypeTokens->basisCurves) return new Curves(path);
  if (type == HdPrimTypeTokens->points) return new Points(path);
  if (is_one_of(implicit_types(), type)) return new Implicit(type, path);
  if (param_.is_news("type " + type.GetString()))
    TF_WARN("%s: prims of type %s are not drawn", path.GetText(), type.GetText());
  return nullptr;
}

void Delegate::DestroyRprim(HdRprim* prim) { delete prim; }

HdSprim* Delegate::CreateSprim(const TfToken& type, const SdfPath& path) {
  if (type == HdPrimTypeTokens->camera) return new Camera(path);
  if (type == HdPrimTypeTokens->material) return new Material(path);
  if (type == HdPrimTypeTokens->extComputation) return new HdExtComputation(path);
  if (is_one_of(Light::types(), type)) return new Light(type, path);
  if (param_.is_news("type " + type.GetString()))
    TF_WARN("%s: prims of type %s are not rendered", path.GetText(), type.GetText());
  return nullptr;
}

HdSprim* Delegate::CreateFallbackSprim(const TfToken& type) {
  return CreateSprim(type, SdfPath::EmptyPath());
}

void Delegate::DestroySprim(HdSprim* prim) { delete prim; }

HdBprim* Delegate::CreateBprim(const TfToken& type, const SdfPath& path) {
  if (type == HdPrimTypeTokens->renderBuffer) return new RenderBuffer(path);
  if (type == HdPrimTypeTokens->renderSettings) return new SettingsPrim(path);
  if (param_.is_news("type " + type.GetString()))
    TF_WARN("%s: prims of type %s are not rendered", path.GetText(), type.GetText());
  return nullptr;
}

HdBprim* Delegate::CreateFallbackBprim(const TfToken& type) {
  return CreateBprim(type, SdfPath::EmptyPath());
}

void Delegate::DestroyBprim(HdBprim* prim) { delete prim; }

void Delegate::SetTerminalSceneIndex(const HdSceneIndexBaseRefPtr& scene) {
  HdRenderDelegate::SetTerminalSceneIndex(scene);
  if (scene) scene->AddObserver(HdSceneIndexObserverPtr(&unsupported_));
}

TfToken Delegate::GetMaterialBindingPurpose() const { return HdTokens->full; }

TfTokenVector Delegate::GetRenderSettingsNamespaces() const { return setting_namespaces(); }

HdAovDescriptor Delegate::GetDefaultAovDescriptor(const TfToken& name) const { return aov_descriptor(name); }

}  // namespace msbvh::hydra
