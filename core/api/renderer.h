// Renders a Scene to pixels.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/build/settings.h"
#include "core/bvh/statistics.h"
#include "core/cost/ray_costs.h"
#include "core/film/film_settings.h"
#include "core/film/image.h"
#include "core/film/noise_goal.h"
#include "core/film/sum_tree.h"
#include "core/integrate/sampler.h"
#include "core/integrate/stage_samples.h"
#include "core/plan/effect_plan.h"
#include "core/probe/probe.h"
#include "core/scene/scene.h"
#include "core/texture/texture_cache.h"
#include "core/trace/tracer.h"

namespace msbvh {

struct RenderSettings {
  std::uint32_t width = 960;
  std::uint32_t height = 540;
  std::uint32_t spp = 64;  // samples a pixel; noise falls with its square root, time grows with it
  NoiseGoal noise{};       // where it decides, spp is the most
  Sampling sampling = Sampling::kSobol;
  std::uint32_t seed = 0;         // same seed, same bits, on any number of threads (one instruction set)
  std::uint32_t max_bounces = 2;  // 0: direct light only
  std::uint32_t threads = 0;      // 0: all
  bool show_domes = true;         // false: domes light the scene, but lie not behind it
  // What is transparent (UsdPreviewSurface's opacityMode) bends light by its ior; false: is seen straight
  // through. Every surface that light passes is a bounce.
  bool refraction = false;
  // Paths that a thread takes forward at once, at most; a few hundred bytes each. Does not change the
  // picture.
  std::uint32_t batch_paths = 4096;
  TextureSettings textures{};
  float texture_rate = 1.0f;    // times the widths that textures are filtered over
  float clamp_indirect = 0.0f;  // most indirect light of a path, against fireflies: loses light; 0: off
  std::vector<Aov> aovs{};      // beside colour and alpha
  // Of the kernels; none: the best that the processor has. Pictures of two sets differ in their last bits.
  std::optional<InstructionSet> instruction_set{};
  bool sample_stages = false;  // fills RenderStatistics::stages. Does not change the picture
  FilmSettings film{};         // its filter and its shutter
  BuildSettings build;
};

struct RenderStatistics {
  BvhStatistics accel;            // sums over all trees
  std::uint64_t trees = 0;        // bottom-level trees and the world's
  TraceModes rays;                // camera, bounce and shadow rays
  std::uint64_t camera_rays = 0;  // samples of the picture, of all pixels
  std::uint32_t spp = 0;  // that render the same picture again: fewer than asked for where time was over
  StageCounts stages;     // what threads were found at, where settings ask for it
  double build_seconds = 0.0;
  double trace_seconds = 0.0;
};

// Called from the thread that called render(), several times a second: finished share in [0, 1]; false
// cancels.
using ProgressFunction = std::function<bool(double)>;

class Renderer {
 public:
  Renderer();
  ~Renderer();

  // Validates, plans and builds. Throws Error; Cancelled if settings.build.cancelled says so. A second commit
  // is the next frame: settings.build.refit says what its trees take over from the last one's. Until it
  // returns, both frames' scenes and trees are held; where it throws, the last frame stays.
  void commit(std::shared_ptr<const Scene> scene, const RenderSettings& settings);
  // All the others throw Error before commit(). Cancelled: within a tile of the progress function's false.
  Image render(const ProgressFunction& progress = {});
  // With as many samples as there is time for, at most settings.spp: whole blocks of them
  // (core/film/sum_tree.h), at least one. statistics().spp says how many. Where settings.noise decides, that
  // is the most of any pixel.
  Image render_within(double seconds, const ProgressFunction& progress = {});
  // Some of each pixel's samples, also beyond settings.spp. Two ranges side by side, weighted by their
  // counts, have the mean of all at once: so samples can be added to a picture without another noise.
  // settings.noise decides nothing here.
  Image render(SampleRange samples, const ProgressFunction& progress = {});

  // A first look: one sample a pixel of the same picture in fewer pixels, with the same AOVs. Not a part of
  // what ranges of samples add up to; the statistics stay as they are. Throws Error for a size above the
  // settings'.
  Image preview(std::uint32_t width, std::uint32_t height, const ProgressFunction& progress = {});

  // Proves the invariants of every tree, as Accel::verify(). For tests: takes seconds on large scenes.
  void verify() const;
  // Traces rays that are likely to find a defect (core/probe/probe.h). Throws Cancelled.
  ProbeReport probe(const ProbeSettings& settings, const ProbeProgress& progress = {}) const;

  // What the frame's rays cost, and which geometry's they are: traces a sample of its paths again, by its
  // own seed, on settings.threads (core/cost/ray_costs.h). Before or after render(), which it does not touch.
  // Throws Cancelled.
  RayCosts ray_costs(const RayCostSettings& settings, const RayCostProgress& progress = {}) const;

  // Textures that could not be read until now, each once; their fallbacks were drawn.
  std::vector<TextureFault> texture_faults() const;
  const std::string& texture_name(TextureId texture) const;
  // The names behind hashes of a Cryptomatte, core/film/name_hash.h; throws Error where none is asked for.
  std::vector<std::pair<std::string, std::uint32_t>> crypto_manifest(
      Aov aov, std::span<const std::uint32_t> hashes) const;

  const EffectPlan& plan() const;
  const RenderStatistics& statistics() const;

 private:
  struct Data;
  Data& committed() const;

  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
