#include "core/base/parallel.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "core/base/error.h"

#ifdef MSBVH_SANITIZE_THREAD
#include <sanitizer/tsan_interface.h>
#endif

namespace msbvh {
namespace {

// What ThreadSanitizer cannot see, since neither TBB nor this file is built for it (CMakeLists.txt): a task
// comes after the call that starts it, and the call's return after all of its tasks. Tasks are not ordered
// among themselves, so that races between them are found. Nothing in other builds.
class CallOrder {
 public:
  CallOrder() { happens_before(started_); }
  ~CallOrder() { happens_after(finished_); }
  CallOrder(const CallOrder&) = delete;
  CallOrder& operator=(const CallOrder&) = delete;

  // Lives as long as one task of the call.
  class Task {
   public:
    explicit Task(CallOrder& call) : call_(call) { happens_after(call_.started_); }
    ~Task() { happens_before(call_.finished_); }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    CallOrder& call_;
  };

 private:
  struct Event {};
#ifdef MSBVH_SANITIZE_THREAD
  static void happens_before(Event& event) { __tsan_release(&event); }
  static void happens_after(Event& event) { __tsan_acquire(&event); }
#else
  static void happens_before(Event&) {}
  static void happens_after(Event&) {}
#endif

  Event started_, finished_;
};

// A call that is nested in one whose other tasks have thrown is cancelled with it: TBB returns without having
// run all of its bodies, and says nothing. Whoever goes on from there would read what was never written.
// The exception ends in the outer call, which rethrows the one that came first.
void stop_if_cancelled(tbb::task_group_context& context) {
  if (context.is_group_execution_cancelled()) throw Cancelled();
}

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  CallOrder call;
  tbb::task_group_context context;
  tbb::parallel_for(
      std::size_t(0), count,
      [&](std::size_t i) {
        const CallOrder::Task task(call);
        body(i);
      },
      context);
  stop_if_cancelled(context);
}

void parallel_for_ranges(std::size_t count, std::size_t grain,
                         const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  if (count <= grain) return body(0, count);
  parallel_for((count + grain - 1) / grain,
               [&](std::size_t chunk) { body(chunk * grain, std::min(count, (chunk + 1) * grain)); });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  CallOrder call;
  const auto task_of = [&call](const std::function<void()>& work) {
    return [&call, &work] {
      const CallOrder::Task task(call);
      work();
    };
  };
  tbb::task_group_context context;
  tbb::parallel_invoke(task_of(a), task_of(b), context);
  stop_if_cancelled(context);
}

struct Arena::Data {
  tbb::task_arena arena;
};

// TBB starts no more threads than the process may use at once; asked for many more, it prints a warning of
// its own.
Arena::Arena(unsigned threads)
    : data_(new Data{tbb::task_arena(threads == 0 ? tbb::task_arena::automatic
                                                  : std::min(static_cast<int>(std::min(threads, 1U << 16)),
                                                             tbb::info::default_concurrency()))}) {}
Arena::~Arena() = default;

void Arena::execute(const std::function<void()>& work) {
  CallOrder call;
  data_->arena.execute([&] {
    const CallOrder::Task task(call);
    work();
  });
}

unsigned Arena::threads() const { return static_cast<unsigned>(data_->arena.max_concurrency()); }

}  // namespace msbvh
