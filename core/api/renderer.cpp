#include "core/api/renderer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/api/background.h"
#include "core/api/scene_trees.h"
#include "core/api/timed_render.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/integrate/learn_lights.h"
#include "core/integrate/render_tile.h"
#include "core/plan/known_effects.h"
#include "core/shade/bsdf/albedo_tables.h"
#include "core/shade/bsdf/glass_tables.h"

namespace msbvh {
namespace {

// Bounds of what one frame can hold; beyond them a number is a mistake.
constexpr std::uint32_t kMaxResolution = 1u << 16;
constexpr std::uint32_t kMaxSpp = 1u << 20;
constexpr std::uint32_t kMaxBounces = 1024;
constexpr float kMostClamp = 1e6f;

// At the keys of the shutter, between which it does not reach further.
Box3f bounds_of(const Bvh& world) {
  Box3f bounds;
  for (const Box3f& b : world.root_bounds) bounds.grow(b);
  return bounds;
}

void expect_range(const char* setting, std::uint32_t found, std::uint32_t least, std::uint32_t most) {
  if (found >= least && found <= most) return;
  throw Error(std::string("render settings: ") + setting + ": found " + std::to_string(found) +
              "; expected " + std::to_string(least) + " to " + std::to_string(most));
}

void expect_number(const char* setting, float found, float least, float most) {
  if (found >= least && found <= most) return;
  throw Error(std::string("render settings: ") + setting + ": found " + std::to_string(found) +
              "; expected " + std::to_string(least) + " to " + std::to_string(most));
}

void check(const RenderSettings& settings) {
  expect_range("width", settings.width, 1, kMaxResolution);
  expect_range("height", settings.height, 1, kMaxResolution);
  expect_range("spp", settings.spp, 1, kMaxSpp);
  expect_range("max_bounces", settings.max_bounces, 0, kMaxBounces);
  expect_range("batch_paths", settings.batch_paths, 1, kMaxBatchPaths);
  check(settings.film);
  check(settings.noise);
  expect_range("min_spp", settings.noise.min_spp, 1, kMaxSpp);
  expect_number("texture_rate", settings.texture_rate, 1.0f / 64.0f, 64.0f);
  expect_number("clamp_indirect", settings.clamp_indirect, 0.0f, kMostClamp);
  if (settings.sample_stages && !kKnownStageMarks) {
    throw Error(
        "render settings: sample_stages: found true; expected false, since MSBVH_OMIT_EFFECTS left "
        "stage-marks out of this build");
  }
}

std::string names_of(const std::vector<Aov>& aovs) {
  std::string names;
  for (const Aov aov : aovs) names.append(names.empty() ? "" : ", ").append(form_of(aov).name);
  return names;
}

Frame frame_of(const Scene& scene, const Bvh& world, const Tracer& tracer, const RenderSettings& settings,
               EffectSet effects, const TextureCache* textures) {
  AovSet asked;
  for (const Aov aov : settings.aovs) asked.add(aov);
  return {SceneIndex(scene),
          LightSampler(scene, bounds_of(world)),
          world,
          tracer,
          settings.width,
          settings.height,
          settings.seed,
          settings.max_bounces,
          settings.show_domes,
          settings.sampling,
          textures,
          choose_stages(effects, settings.sampling, world, settings.film, asked),
          FilterSampler(settings.film.filter),
          ShutterSampler(settings.film.shutter_curve, settings.film.rolling),
          asked,
          settings.film.frame_time,
          settings.film.origin,
          asked.crypto() ? CryptoNames(scene) : CryptoNames(),
          settings.film.shutter_slices,
          settings.texture_rate,
          settings.clamp_indirect,
          effects.has(Effect::kRefraction),
          effects.has(Effect::kFibre),
          settings.film.exposure};
}

Tracer tracer_of(const Bvh& world, const RenderSettings& settings) {
  return settings.instruction_set ? Tracer(world, *settings.instruction_set) : Tracer(world);
}

// How long a render goes on at most that has been cancelled, beside the tiles at hand.
constexpr std::chrono::milliseconds kProgressInterval{25};

// A frame in another size, as long as this lives.
class FewerPixels {
 public:
  FewerPixels(Frame& frame, std::uint32_t width, std::uint32_t height)
      : frame_(frame), width_(frame.width), height_(frame.height) {
    frame_.width = width;
    frame_.height = height;
  }
  ~FewerPixels() {
    frame_.width = width_;
    frame_.height = height_;
  }
  FewerPixels(const FewerPixels&) = delete;
  FewerPixels& operator=(const FewerPixels&) = delete;

 private:
  Frame& frame_;
  std::uint32_t width_, height_;
};

// Before threads need them: one that made them among others' tiles could be given a tile to wait by, which
// needs them too.
void make_tables(const EffectSet& effects) {
  if (effects.has(Effect::kSpecular)) AlbedoTables::get();
  if (effects.has(Effect::kRefraction)) GlassTables::get();
}

// What a render leaves beside its picture.
struct Traced : AreaTraced {
  StageCounts stages;  // of settings.sample_stages
};

}  // namespace

struct Renderer::Data {
  std::shared_ptr<const Scene> scene;
  RenderSettings settings;
  EffectPlan plan;
  RenderStatistics statistics;
  std::optional<SceneTrees> trees;
  std::optional<TextureCache> textures;  // where the plan has some
  std::optional<Frame> frame;

  void build(SceneTrees* previous);
  // Of `samples` of each pixel of `frame`, which is this data's in some size. Adds to `traced`.
  Image render(const Frame& drawn, SampleRange samples, const NoiseGoal& noise,
               const ProgressFunction& progress, Traced& traced) const;
  Image empty_image(const Frame& drawn) const;
  void note(const Traced& traced, std::uint32_t samples, double seconds);

 private:
  void render_tiles(const TileJob& job, Image& image, std::atomic<std::size_t>& finished_tiles,
                    Traced& traced) const;
};

void Renderer::Data::build(SceneTrees* previous) {
  const Stopwatch watch;
  Arena(settings.threads).execute([&] { trees.emplace(scene, settings.build, previous); });
  statistics.build_seconds = watch.seconds();
  trees->add_to(statistics.accel, statistics.trees);
}

void Renderer::Data::render_tiles(const TileJob& job, Image& image, std::atomic<std::size_t>& finished_tiles,
                                  Traced& traced) const {
  const TileGrid grid(image.width, image.height);
  std::optional<StageSampler> sampler;
  if (settings.sample_stages) sampler.emplace();
  WorkspacePool workspaces(sampler ? &*sampler : nullptr);
  std::mutex summing;
  Arena(settings.threads).execute([&] {
    parallel_for(grid.count(), [&](std::size_t i) {
      std::unique_ptr<TileWorkspace> workspace = workspaces.take();
      const AreaTraced of_tile = render_tile(job, grid.tile(i), *workspace, image);
      workspaces.give_back(std::move(workspace));
      {
        const std::scoped_lock lock(summing);
        static_cast<AreaTraced&>(traced) += of_tile;
      }
      ++finished_tiles;
    });
  });
  if (sampler) traced.stages = sampler->stop();
}

Image Renderer::Data::empty_image(const Frame& drawn) const {
  Image image{drawn.width, drawn.height, {}, {}, {}};
  const std::size_t pixels = std::size_t(drawn.width) * drawn.height;
  image.rgba.resize(4 * pixels);
  for (const Aov aov : settings.aovs) image.aovs.emplace_back(aov, pixels);
  image.slices.resize(4 * pixels * drawn.shutter_slices);
  return image;
}

void Renderer::Data::note(const Traced& traced, std::uint32_t samples, double seconds) {
  statistics.trace_seconds = seconds;
  statistics.stages = traced.stages;
  statistics.rays = traced.rays;
  statistics.camera_rays = traced.samples;
  statistics.spp = samples;
}

Image Renderer::Data::render(const Frame& drawn, SampleRange samples, const NoiseGoal& noise,
                             const ProgressFunction& progress, Traced& traced) const {
  Image image = empty_image(drawn);
  const double tiles = static_cast<double>(TileGrid(drawn.width, drawn.height).count());
  std::atomic<std::size_t> finished_tiles = 0;
  std::atomic<bool> cancelled = false;

  const TileJob job{drawn, samples, settings.batch_paths, cancelled, noise};
  Background work([&] { render_tiles(job, image, finished_tiles, traced); });
  try {
    while (!work.finished_within(kProgressInterval)) {
      if (progress && !progress(static_cast<double>(finished_tiles) / tiles)) throw Cancelled();
    }
    work.join();
    if (progress && !progress(1.0)) throw Cancelled();
  } catch (...) {
    cancelled = true;  // the destructor of `work` waits for the tiles at hand
    throw;
  }
  return image;
}

Renderer::Renderer() = default;
Renderer::~Renderer() = default;

void Renderer::commit(std::shared_ptr<const Scene> scene, const RenderSettings& settings) {
  check(settings);
  if (!scene) throw Error("renderer: found no scene behind the pointer; expected one");
  validate(*scene);
  auto data = std::make_unique<Data>();
  data->scene = std::move(scene);
  data->settings = settings;
  data->plan = plan_effects(*data->scene, {.max_bounces = settings.max_bounces,
                                           .aovs = names_of(settings.aovs),
                                           .refraction = settings.refraction});
  expect_known(data->plan, kKnownEffects);
  data->build(data_ && data_->trees ? &*data_->trees : nullptr);
  const Bvh& world = data->trees->world().bvh();
  if (data->plan.set.has(Effect::kTextures)) data->textures.emplace(data->scene->textures, settings.textures);
  data->frame.emplace(frame_of(*data->scene, world, tracer_of(world, settings), settings, data->plan.set,
                               data->textures ? &*data->textures : nullptr));
  Arena(settings.threads).execute([&] {
    make_tables(data->plan.set);
    learn_lights(*data->frame);
  });
  data_ = std::move(data);
}

Image Renderer::render(const ProgressFunction& progress) {
  Data& data = committed();
  Traced traced;
  const Stopwatch watch;
  const SampleRange samples{0, data.settings.spp};
  Image image = data.render(*data.frame, samples, data.settings.noise, progress, traced);
  data.note(traced, samples.count, watch.seconds());
  return image;
}

Image Renderer::render(SampleRange samples, const ProgressFunction& progress) {
  Data& data = committed();
  expect_range("first sample", samples.first, 0, kMaxSpp);
  expect_range("samples", samples.count, 1, kMaxSpp);
  Traced traced;
  const Stopwatch watch;
  Image image = data.render(*data.frame, samples, {}, progress, traced);
  data.note(traced, samples.count, watch.seconds());
  return image;
}

Image Renderer::render_within(double seconds, const ProgressFunction& progress) {
  Data& data = committed();
  if (!(seconds > 0.0) || std::isinf(seconds))
    throw Error("time limit: found " + std::to_string(seconds) + "; expected a finite number above 0");
  Traced traced;
  const Stopwatch watch;
  TimedPicture timed =
      render_timed(*data.frame, data.settings, seconds, data.empty_image(*data.frame), progress, traced);
  traced.stages = timed.stages;
  data.note(traced, timed.samples, watch.seconds());
  return std::move(timed.image);
}

Image Renderer::preview(std::uint32_t width, std::uint32_t height, const ProgressFunction& progress) {
  Data& data = committed();
  expect_range("width of a preview", width, 1, data.settings.width);
  expect_range("height of a preview", height, 1, data.settings.height);
  const FewerPixels fewer(*data.frame, width, height);
  Traced unused;
  return data.render(*data.frame, {0, 1}, {}, progress, unused);
}

Renderer::Data& Renderer::committed() const {
  if (!data_) throw Error("renderer: used before commit()");
  return *data_;
}

std::vector<std::pair<std::string, std::uint32_t>> Renderer::crypto_manifest(
    Aov aov, std::span<const std::uint32_t> hashes) const {
  const Frame& frame = *committed().frame;
  if (form_of(aov).merge != AovMerge::kCoverage || !frame.aovs.crypto())
    throw Error(std::string("cryptomatte manifest: found ") + form_of(aov).name +
                "; expected a Cryptomatte among the AOVs");
  return frame.crypto_names.manifest(aov, hashes);
}

void Renderer::verify() const { committed().trees->verify(); }
ProbeReport Renderer::probe(const ProbeSettings& settings, const ProbeProgress& progress) const {
  return msbvh::probe(committed().trees->world().bvh(), settings, progress);
}

RayCosts Renderer::ray_costs(const RayCostSettings& settings, const RayCostProgress& progress) const {
  const Data& data = committed();
  const Bvh& world = data.trees->world().bvh();
  Frame logging = frame_of(*data.scene, world, Tracer::logging(world), data.settings,
                           data.plan.set.without(Effect::kAovs), data.textures ? &*data.textures : nullptr);
  RayCosts costs;
  Arena(data.settings.threads).execute([&] {
    learn_lights(logging);
    costs = msbvh::ray_costs(logging, data.settings.build, data.settings.spp, settings, progress);
  });
  return costs;
}

std::vector<TextureFault> Renderer::texture_faults() const {
  const Data& data = committed();
  return data.textures ? data.textures->faults() : std::vector<TextureFault>{};
}

const std::string& Renderer::texture_name(TextureId texture) const {
  return committed().scene->textures.at(texture).name;
}

const EffectPlan& Renderer::plan() const { return committed().plan; }
const RenderStatistics& Renderer::statistics() const { return committed().statistics; }

}  // namespace msbvh
