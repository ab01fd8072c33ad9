#include "core/api/renderer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "core/api/accel.h"
#include "core/api/background.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/film/render_tile.h"

namespace msbvh {
namespace {

// Bounds of what one frame can hold; beyond them a number is a mistake.
constexpr std::uint32_t kMaxResolution = 1u << 16;
constexpr std::uint32_t kMaxSpp = 1u << 20;
constexpr std::uint32_t kMaxBounces = 1024;

void expect_range(const char* setting, std::uint32_t found, std::uint32_t least, std::uint32_t most) {
  if (found >= least && found <= most) return;
  throw Error(std::string("render settings: ") + setting + ": found " + std::to_string(found) +
              "; expected " + std::to_string(least) + " to " + std::to_string(most));
}

void check(const RenderSettings& settings) {
  expect_range("width", settings.width, 1, kMaxResolution);
  expect_range("height", settings.height, 1, kMaxResolution);
  expect_range("spp", settings.spp, 1, kMaxSpp);
  expect_range("max_bounces", settings.max_bounces, 0, kMaxBounces);
}

// Trees read the scene's own positions, and keep the scene alive for it. It has passed validate().
void share_meshes(const std::shared_ptr<const Scene>& scene, const std::vector<std::uint32_t>& meshes,
                  Accel& accel) {
  for (const std::uint32_t mesh : meshes) {
    accel.add_mesh(std::shared_ptr<const TriangleMesh>(scene, &scene->meshes[mesh].shape));
  }
}

// The builder asks only now and then, which for thousands of small trees is never.
void stop_if_cancelled(const BuildSettings& settings) {
  if (settings.cancelled && settings.cancelled()) throw Cancelled();
}

// One tree a prototype that has instances, null for the others.
std::vector<std::shared_ptr<const Accel>> build_prototypes(const std::shared_ptr<const Scene>& scene,
                                                           const BuildSettings& settings) {
  std::vector<std::shared_ptr<Accel>> accels(scene->prototypes.size());
  for (const InstanceSet& set : scene->instances) {
    if (instance_count(set) > 0 && !accels[set.prototype]) accels[set.prototype] = std::make_shared<Accel>();
  }
  parallel_for(accels.size(), [&](std::size_t i) {
    if (!accels[i]) return;
    stop_if_cancelled(settings);
    share_meshes(scene, scene->prototypes[i].meshes, *accels[i]);
    accels[i]->set_clock(scene->prototypes[i].clock);
    accels[i]->commit(settings);
  });
  return {accels.begin(), accels.end()};
}

// Meshes and instances in the order that SceneIndex counts on.
Accel build_world(const std::shared_ptr<const Scene>& scene,
                  const std::vector<std::shared_ptr<const Accel>>& prototypes,
                  const BuildSettings& settings) {
  stop_if_cancelled(settings);
  Accel world;
  share_meshes(scene, scene->world_meshes, world);
  for (const InstanceSet& set : scene->instances) {
    if (instance_count(set) == 0) continue;
    world.add_instances(prototypes[set.prototype], set.form(), set.world_from_prototype, set.clock);
  }
  world.commit(settings);
  return world;
}

constexpr std::chrono::milliseconds kProgressInterval{100};

}  // namespace

struct Renderer::Data {
  std::shared_ptr<const Scene> scene;
  RenderSettings settings;
  EffectPlan plan;
  RenderStatistics statistics;
  std::vector<std::shared_ptr<const Accel>> prototypes;
  std::optional<Accel> world;
  std::optional<FrameContext> frame;

  void build();
  void render_tiles(float* rgba, std::atomic<std::size_t>& finished_tiles,
                    const std::atomic<bool>& cancelled);
};

void Renderer::Data::build() {
  const Stopwatch watch;
  Arena(settings.threads).execute([&] {
    prototypes = build_prototypes(scene, settings.build);
    world = build_world(scene, prototypes, settings.build);
  });
  statistics.build_seconds = watch.seconds();
  for (const std::shared_ptr<const Accel>& prototype : prototypes) {
    if (!prototype) continue;
    statistics.accel += prototype->statistics();
    ++statistics.trees;
  }
  statistics.accel += world->statistics();
  ++statistics.trees;
}

void Renderer::Data::render_tiles(float* rgba, std::atomic<std::size_t>& finished_tiles,
                                  const std::atomic<bool>& cancelled) {
  const TileGrid grid(settings.width, settings.height);
  const TileJob job{*frame, settings.width, settings.height, settings.spp, settings.seed, cancelled};
  const RenderTile render_tile = choose_render_tile(plan.set);
  std::atomic<std::uint64_t> rays = 0;
  const Stopwatch watch;
  Arena(settings.threads).execute([&] {
    parallel_for(grid.count(), [&](std::size_t i) {
      rays += render_tile(job, grid.tile(i), rgba);
      ++finished_tiles;
    });
  });
  statistics.trace_seconds = watch.seconds();
  statistics.rays = rays;
  statistics.camera_rays = std::uint64_t(settings.width) * settings.height * settings.spp;
}

Renderer::Renderer() = default;
Renderer::~Renderer() = default;

void Renderer::commit(std::shared_ptr<const Scene> scene, const RenderSettings& settings) {
  check(settings);
  validate(*scene);
  auto data = std::make_unique<Data>();
  data->scene = std::move(scene);
  data->settings = settings;
  data->plan = plan_effects(*data->scene, {.max_bounces = settings.max_bounces});
  data->build();
  data->frame.emplace(FrameContext{SceneIndex(*data->scene), LightSet(*data->scene),
                                   Tracer(data->world->bvh()), settings.max_bounces, settings.show_domes});
  data_ = std::move(data);
}

Image Renderer::render(const ProgressFunction& progress) {
  Data& data = committed();
  const RenderSettings& settings = data.settings;
  Image image{settings.width, settings.height, {}};
  image.rgba.resize(std::size_t(4) * settings.width * settings.height);
  const double tiles = static_cast<double>(TileGrid(settings.width, settings.height).count());
  std::atomic<std::size_t> finished_tiles = 0;
  std::atomic<bool> cancelled = false;

  Background work([&] { data.render_tiles(image.rgba.data(), finished_tiles, cancelled); });
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

Renderer::Data& Renderer::committed() const {
  if (!data_) throw Error("renderer: used before commit()");
  return *data_;
}

void Renderer::verify() const {
  const Data& data = committed();
  for (const std::shared_ptr<const Accel>& prototype : data.prototypes) {
    if (prototype) prototype->verify();
  }
  data.world->verify();
}

const EffectPlan& Renderer::plan() const { return committed().plan; }
const RenderStatistics& Renderer::statistics() const { return committed().statistics; }

}  // namespace msbvh
