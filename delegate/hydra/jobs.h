// The render jobs of a delegate: one a render pass, each with the buffers that it fills. Delegate and passes
// share them, since hosts may destroy them in any order.
//
// All of it is the host's thread's, but status() and idle(), which may be asked from any. Whatever a render
// thread has to say waits here until the host calls again: a warning that a host's script listens to would
// wait for that host, which may be waiting for the render thread.
#pragma once

#include <atomic>
#include <mutex>
#include <vector>

#include "delegate/hydra/picture_writer.h"
#include "delegate/translate/frame/render_job.h"

namespace msbvh::hydra {

class RenderBuffer;

// Of a render pass.
struct PassJob {
  explicit PassJob(RenderParam& param) : writer(param) {}

  PictureWriter writer;
  translate::RenderJob job{writer};  // last: its thread ends before the rest goes
};

class Jobs {
 public:
  void add(PassJob& pass);
  void remove(PassJob& pass);
  // The one that status() is of: it was begun last.
  void set_current(PassJob& pass);

  translate::JobStatus status() const;
  bool idle() const;
  bool paused() const { return paused_; }
  void pause();
  void resume();
  void stop(bool wait = true);
  void restart();
  // Before a buffer changes or goes: nothing renders any more, and nothing will into that one.
  void forget(const RenderBuffer& buffer);
  void tell_failures();

 private:
  mutable std::mutex mutex_;  // for passes_ and current_, which the host's thread alone changes
  std::vector<PassJob*> passes_;
  PassJob* current_ = nullptr;
  std::atomic<bool> paused_{false};
};

}  // namespace msbvh::hydra
