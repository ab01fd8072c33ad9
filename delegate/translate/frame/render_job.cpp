#include "delegate/translate/frame/render_job.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "core/base/error.h"

namespace msbvh::translate {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

RenderJob::RenderJob(PictureSink& sink) : sink_(sink), thread_([this] { work(); }) {}

RenderJob::~RenderJob() {
  {
    const std::scoped_lock lock(mutex_);
    cancel_ = quit_ = true;
    status_.paused = false;
  }
  changed_.notify_all();
  thread_.join();
}

void RenderJob::start(std::shared_ptr<const Scene> scene, const RenderSettings& settings) {
  stop();
  {
    const std::scoped_lock lock(mutex_);
    last_ = Order{std::move(scene), settings};
    order_ = last_;
    cancel_ = false;
    const bool paused = status_.paused;
    status_ = {};
    status_.paused = paused;
    status_.wanted = settings.spp;
    status_.building = true;
    began_ = Clock::now();
  }
  changed_.notify_all();
}

void RenderJob::stop(bool wait) {
  std::unique_lock lock(mutex_);
  order_.reset();
  cancel_ = status_.stopped = true;
  changed_.notify_all();
  if (busy_ && !wait) return;
  changed_.wait(lock, [this] { return !busy_; });
  status_.building = status_.tracing = false;
}

void RenderJob::pause() {
  const std::scoped_lock lock(mutex_);
  status_.paused = true;
}

void RenderJob::resume() {
  {
    const std::scoped_lock lock(mutex_);
    status_.paused = false;
  }
  changed_.notify_all();
}

void RenderJob::restart() {
  stop();
  {
    const std::scoped_lock lock(mutex_);
    if (!last_) return;
    order_ = last_;
    cancel_ = false;
    status_.stopped = status_.converged = false;
    status_.building = true;
    status_.samples = 0;
    status_.fraction = 0.0;
    began_ = Clock::now();
  }
  changed_.notify_all();
}

void RenderJob::give_up() {
  stop();
  const std::scoped_lock lock(mutex_);
  status_.converged = true;
}

JobStatus RenderJob::status() const {
  const std::scoped_lock lock(mutex_);
  JobStatus status = status_;
  if (busy_) status.seconds = seconds_since(began_);
  return status;
}

bool RenderJob::cancelled() const {
  const std::scoped_lock lock(mutex_);
  return cancel_;
}

void RenderJob::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return quit_ || order_.has_value(); });
    if (quit_) return;
    const Order order = std::move(*order_);
    order_.reset();
    busy_ = true;
    lock.unlock();
    std::string fault;
    try {
      render(order);
    } catch (const Cancelled&) {  // by stop()
    } catch (const std::exception& error) {
      fault = error.what();
    }
    if (!fault.empty()) sink_.failed(fault);
    lock.lock();
    status_.seconds = seconds_since(began_);
    status_.building = status_.tracing = false;
    if (!fault.empty()) status_.converged = true;  // nobody need wait for more
    busy_ = false;
    changed_.notify_all();
  }
}

void RenderJob::render(const Order& order) {
  sum_.clear();
  settings_ = order.settings;
  settings_.build.cancelled = [this] { return cancelled(); };
  renderer_.commit(order.scene, settings_);
  {
    const std::scoped_lock lock(mutex_);
    status_.building = false;
    status_.tracing = true;
    status_.wanted = settings_.spp;
    status_.statistics = renderer_.statistics();
  }
  show_preview();
  while (step()) wait_while_paused();
}

void RenderJob::wait_while_paused() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return cancel_ || !status_.paused; });
  if (cancel_) throw Cancelled();
}

void RenderJob::show(const Image& picture, std::uint32_t samples, bool last) {
  sink_.show(picture, samples, last);
  const std::scoped_lock lock(mutex_);
  if (status_.first_picture_seconds == 0.0) status_.first_picture_seconds = seconds_since(began_);
}

// Notes the share of all samples that is done.
bool RenderJob::go_on(double done) {
  const std::scoped_lock lock(mutex_);
  status_.fraction = done;
  return !cancel_;
}

void RenderJob::show_preview() {
  const std::uint32_t divisor = preview_divisor(settings_.width, settings_.height, seconds_a_sample_);
  if (divisor == 1) return;
  const Image small = renderer_.preview(settings_.width / divisor, settings_.height / divisor,
                                        [this](double) { return !cancelled(); });
  show(enlarged(small, settings_.width, settings_.height), 0, false);
}

// Where noise decides, as many as every pixel has.
std::uint32_t RenderJob::samples_shown() const {
  const NoiseGoal& noise = settings_.noise;
  return noise.decides() ? std::min(settings_.spp, noise.least_samples()) : settings_.spp;
}

// All samples once more, as many of each pixel as its noise asks for. None are left then.
bool RenderJob::render_to_noise() {
  const Image picture = renderer_.render([&](double done) { return go_on(done); });
  show(picture, settings_.spp, true);
  const std::scoped_lock lock(mutex_);
  status_.samples = settings_.spp;
  status_.fraction = 1.0;
  status_.converged = true;
  status_.statistics = renderer_.statistics();
  return false;
}

// Whether there are samples left.
bool RenderJob::step() {
  const SampleRange range = next_samples(sum_.samples(), samples_shown());
  if (range.count == 0) return settings_.noise.decides() && render_to_noise();
  const Image picture = renderer_.render(
      range, [&](double done) { return go_on((range.first + done * range.count) / settings_.spp); });
  const RenderStatistics& found = renderer_.statistics();
  seconds_a_sample_ = found.trace_seconds / double(found.camera_rays);
  sum_.add(picture, range.count);
  const bool last = sum_.samples() >= settings_.spp;
  show(sum_.picture(), sum_.samples(), last);
  const std::scoped_lock lock(mutex_);
  status_.samples = sum_.samples();
  status_.fraction = double(sum_.samples()) / settings_.spp;
  status_.converged = last;
  status_.statistics = found;
  return !last;
}

}  // namespace msbvh::translate
