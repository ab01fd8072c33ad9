// Parallelism for the whole library; the only module that knows TBB.
//
// Determinism is the caller's part: a loop body writes only what its index owns, and reductions go over fixed
// chunks in order, never over what a thread happened to process. Exceptions of a body cancel the loop, and
// loops inside it, and are rethrown. A call that returns has run all of its bodies: what an outer call's
// exception stops throws Cancelled, and that exception is the one that is seen in the end.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace msbvh {

// body(i) for every i in [0, count).
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

// body(begin, end) over consecutive ranges of exactly `grain` elements (the last may be shorter): the ranges
// do not depend on the number of threads. One range runs on the calling thread without overhead.
void parallel_for_ranges(std::size_t count, std::size_t grain,
                         const std::function<void(std::size_t, std::size_t)>& body);

// Runs both, possibly at the same time.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

// A bound on the number of threads. Parallel calls made inside execute() use at most that many.
class Arena {
 public:
  explicit Arena(unsigned threads);  // 0: all
  ~Arena();
  void execute(const std::function<void()>& work);
  unsigned threads() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
