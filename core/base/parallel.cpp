#include "core/base/parallel.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

namespace msbvh {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t(0), count, body);
}

void parallel_for_ranges(std::size_t count, std::size_t grain,
                         const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  if (count <= grain) return body(0, count);
  parallel_for((count + grain - 1) / grain,
               [&](std::size_t chunk) { body(chunk * grain, std::min(count, (chunk + 1) * grain)); });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  tbb::parallel_invoke(a, b);
}

struct Arena::Data {
  tbb::task_arena arena;
};

Arena::Arena(unsigned threads)
    : data_(
          new Data{tbb::task_arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads))}) {}
Arena::~Arena() = default;

void Arena::execute(const std::function<void()>& work) { data_->arena.execute(work); }

unsigned Arena::threads() const { return static_cast<unsigned>(data_->arena.max_concurrency()); }

}  // namespace msbvh
