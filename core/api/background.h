// Work on a thread of its own, so that the calling thread can report progress and ask for cancellation
// meanwhile.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace msbvh {

// The destructor waits for the work to end; what it threw is then lost unless join() has been called.
class Background {
 public:
  explicit Background(const std::function<void()>& work) : thread_([this, work] { run(work); }) {}
  ~Background() {
    if (thread_.joinable()) thread_.join();
  }

  // True once the work has ended, within `wait` at most.
  bool finished_within(std::chrono::milliseconds wait) {
    std::unique_lock lock(mutex_);
    return ended_condition_.wait_for(lock, wait, [this] { return ended_; });
  }

  // Waits, and rethrows what the work threw.
  void join() {
    thread_.join();
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  void run(const std::function<void()>& work) {
    try {
      work();
    } catch (...) {
      exception_ = std::current_exception();
    }
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    ended_condition_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable ended_condition_;
  bool ended_ = false;
  std::exception_ptr exception_;
  std::thread thread_;  // last: starts when the rest is ready
};

}  // namespace msbvh
