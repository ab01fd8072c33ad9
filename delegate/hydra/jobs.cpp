#include "delegate/hydra/jobs.h"

#include <algorithm>

#include "delegate/hydra/render_buffer.h"

namespace msbvh::hydra {

void Jobs::add(PassJob& pass) {
  if (paused_) pass.job.pause();
  const std::scoped_lock lock(mutex_);
  passes_.push_back(&pass);
}

void Jobs::remove(PassJob& pass) {
  const std::scoped_lock lock(mutex_);
  std::erase(passes_, &pass);
  if (current_ == &pass) current_ = nullptr;
}

void Jobs::set_current(PassJob& pass) {
  const std::scoped_lock lock(mutex_);
  current_ = &pass;
}

translate::JobStatus Jobs::status() const {
  const std::scoped_lock lock(mutex_);
  return current_ ? current_->job.status() : translate::JobStatus();
}

bool Jobs::idle() const {
  const std::scoped_lock lock(mutex_);
  return std::all_of(passes_.begin(), passes_.end(), [](const PassJob* pass) {
    const translate::JobStatus status = pass->job.status();
    return !status.building && !status.tracing;
  });
}

void Jobs::pause() {
  paused_ = true;
  for (PassJob* pass : passes_) pass->job.pause();
}

void Jobs::resume() {
  paused_ = false;
  for (PassJob* pass : passes_) pass->job.resume();
}

void Jobs::stop(bool wait) {
  for (PassJob* pass : passes_) pass->job.stop(false);  // side by side
  if (!wait) return;
  for (PassJob* pass : passes_) pass->job.stop();
}

void Jobs::restart() {
  for (PassJob* pass : passes_) pass->job.restart();
}

void Jobs::forget(const RenderBuffer& buffer) {
  stop();
  for (PassJob* pass : passes_) pass->writer.forget(buffer);
}

void Jobs::tell_failures() {
  for (PassJob* pass : passes_) pass->writer.tell_failure();
}

}  // namespace msbvh::hydra
