// Renders a Scene on a thread of its own, a few samples at a time, and shows the picture after each step;
// before the first one, where that takes long, a picture of fewer pixels.
//
//            start()                       all samples taken
//   idle ------------> building -> tracing ------------------> idle (converged)
//    ^                    |          | ^ pause(), resume(): it waits between two steps, samples kept
//    |       stop()       |          | |
//    +--------------------+----------+-+   restart(): the same again, from the first sample; trees that are
//    there are kept
//
// The thread sees nothing but the Scene, which does not change. All members may be called from one thread,
// the host's; status() from any.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/api/renderer.h"
#include "delegate/translate/frame/preview.h"
#include "delegate/translate/frame/sample_sum.h"

namespace msbvh::translate {

// Where pictures go. Called on the render thread.
class PictureSink {
 public:
  virtual ~PictureSink() = default;

  // The picture of the first `samples` samples of each pixel, 0: of one sample of fewer pixels (preview.h);
  // `last`: there will be no better one.
  virtual void show(const Image& picture, std::uint32_t samples, bool last) = 0;
  // What could not be rendered, in one line; there will be no picture.
  virtual void failed(const std::string& why) = 0;
};

struct JobStatus {
  std::uint32_t samples = 0, wanted = 0;  // of each pixel
  double fraction = 0.0;                  // of all samples, those under way included
  double seconds = 0.0;                   // since start(); until it ended
  double first_picture_seconds = 0.0;     // from start() to the first picture that was shown; 0: none yet
  bool building = false, tracing = false, paused = false, stopped = false, converged = false;
  RenderStatistics statistics{};  // of the last commit and the last step
};

class RenderJob {
 public:
  // `sink` must live longer.
  explicit RenderJob(PictureSink& sink);
  ~RenderJob();  // stops

  // Stops what is under way; the trees of the last scene are kept as settings.build says.
  void start(std::shared_ptr<const Scene> scene, const RenderSettings& settings);
  // Returns when the thread no longer works, nor shows; `wait` false: at once, while it ends what it is at.
  // Samples stay where they are shown.
  void stop(bool wait = true);
  void pause();
  void resume();
  // After stop(), or in the middle: the same again.
  void restart();
  // Nothing will come of what was wanted: status() says converged, so that nobody waits for it.
  void give_up();

  JobStatus status() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Order {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
  };

  void work();
  void render(const Order& order);
  void show_preview();
  void show(const Image& picture, std::uint32_t samples, bool last);
  bool go_on(double done);
  bool step();
  std::uint32_t samples_shown() const;
  bool render_to_noise();
  bool cancelled() const;
  void wait_while_paused();

  PictureSink& sink_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Order> order_, last_;  // to be begun; for restart()
  bool busy_ = false, cancel_ = false, quit_ = false;
  JobStatus status_;
  Clock::time_point began_{};
  // Of the thread alone:
  Renderer renderer_;
  RenderSettings settings_;
  SampleSum sum_;
  double seconds_a_sample_ = kAssumedSampleSeconds;  // of one pixel, in the last step
  std::thread thread_;                               // last: starts when the rest is ready
};

}  // namespace msbvh::translate
