#include "core/api/timed_render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/api/background.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/integrate/render_tile.h"

namespace msbvh {
namespace {

// How long a pass goes on at most after its time is over, beside the batches at hand.
constexpr std::chrono::milliseconds kLookInterval{10};
// Of the time that is left: what a pass may be expected to take, since no two take the same.
constexpr double kSafe = 0.95;

// Passes and what they took.
class Passes {
 public:
  Passes(double seconds, std::uint32_t most, const NoiseGoal& noise)
      : seconds_(seconds), most_(most), noise_(noise) {}

  std::uint32_t done() const { return done_; }
  double share() const { return std::min(0.999, watch_.seconds() / seconds_); }
  bool late() const { return done_ > 0 && watch_.seconds() > seconds_; }

  // Samples that there are after the next pass; done() where there is none.
  std::uint32_t next() const {
    if (done_ == 0) return std::min(most_, kBlockSamples);
    const double left = kSafe * (seconds_ - watch_.seconds());
    const double fitting = left / seconds_a_sample_;
    if (noise_.decides()) {
      const std::uint32_t next = std::min(most_, after(done_));
      return double(next - done_) <= fitting ? next : done_;
    }
    const auto blocks = static_cast<std::uint32_t>(std::clamp(fitting / kBlockSamples, 0.0, 65536.0));
    return std::min(most_, done_ + std::min(blocks * kBlockSamples, done_));
  }
  void finished(std::uint32_t samples, double seconds) {
    seconds_a_sample_ = seconds / double(samples - done_);
    done_ = samples;
  }

 private:
  // Where noise is judged (core/film/noise_estimate.h): 2^k and 3 * 2^k samples.
  std::uint32_t after(std::uint32_t samples) const {
    const std::uint32_t least = noise_.least_samples();
    if (samples < least) return std::min(least, 2 * samples);
    return (samples & (samples - 1)) == 0 ? samples / 2 * 3 : samples / 3 * 4;
  }

  Stopwatch watch_;
  double seconds_;
  std::uint32_t most_;
  NoiseGoal noise_;
  std::uint32_t done_ = 0;
  double seconds_a_sample_ = 0.0;  // of all pixels, in the last pass
};

class TimedFrame {
 public:
  TimedFrame(const Frame& frame, const RenderSettings& settings, const Image& empty)
      : settings_(settings),
        empty_(empty),
        job_{frame, {0, settings.spp}, settings.batch_paths, cancelled_, settings.noise} {
    const TileGrid grid(empty.width, empty.height);
    tiles_.resize(grid.count());
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      for (const Tile& pixels : areas_of(job_, grid.tile(i))) tiles_[i].emplace_back().begin(job_, pixels);
    }
  }

  TimedPicture render(double seconds, const ProgressFunction& progress, AreaTraced& traced) {
    Passes passes(seconds, settings_.spp, settings_.noise);
    if (settings_.sample_stages) sampler_.emplace();
    TimedPicture done;
    for (std::uint32_t next = passes.next(); next > passes.done() && !clean(); next = passes.next()) {
      const Stopwatch watch;
      Image image = empty_;
      if (!pass(next, passes, progress, image, traced)) break;
      done.image = std::move(image);
      passes.finished(next, watch.seconds());
    }
    if (sampler_) done.stages = sampler_->stop();
    done.samples = passes.done();
    if (progress && !progress(1.0)) throw Cancelled();
    return done;
  }

 private:
  bool clean() const {
    return std::ranges::all_of(tiles_, [](const std::vector<PixelArea>& areas) {
      return std::ranges::all_of(areas, &PixelArea::clean);
    });
  }

  // Brings all pixels to `count` samples. False: there was no time for it.
  bool pass(std::uint32_t count, const Passes& passes, const ProgressFunction& progress, Image& image,
            AreaTraced& traced) {
    AreaTraced of_pass;
    Background work([&] { advance(count, image, of_pass); });
    try {
      while (!work.finished_within(kLookInterval)) {
        if (progress && !progress(passes.share())) throw Cancelled();
        if (passes.late()) cancelled_ = true;
      }
    } catch (...) {
      cancelled_ = true;  // the destructor of `work` waits for the batches at hand
      throw;
    }
    work.join();
    if (cancelled_) of_pass.samples = 0;  // none of the picture's
    traced += of_pass;
    return !cancelled_;
  }

  void advance(std::uint32_t count, Image& image, AreaTraced& traced) {
    WorkspacePool workspaces(sampler_ ? &*sampler_ : nullptr);
    std::mutex summing;
    Arena(settings_.threads).execute([&] {
      parallel_for(tiles_.size(), [&](std::size_t i) {
        std::unique_ptr<TileWorkspace> workspace = workspaces.take();
        AreaTraced of_tile;
        for (PixelArea& area : tiles_[i]) {
          if (!area.advance(job_, count, workspace->batch, of_tile)) break;
          area.resolve(job_.frame, image);
          area.trim();
        }
        workspaces.give_back(std::move(workspace));
        const std::scoped_lock lock(summing);
        traced += of_tile;
      });
    });
  }

  const RenderSettings& settings_;
  const Image& empty_;
  std::atomic<bool> cancelled_ = false;
  TileJob job_;
  std::vector<std::vector<PixelArea>> tiles_;
  std::optional<StageSampler> sampler_;
};

}  // namespace

TimedPicture render_timed(const Frame& frame, const RenderSettings& settings, double seconds,
                          const Image& empty, const ProgressFunction& progress, AreaTraced& traced) {
  return TimedFrame(frame, settings, empty).render(seconds, progress, traced);
}

}  // namespace msbvh
