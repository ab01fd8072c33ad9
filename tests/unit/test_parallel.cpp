// Exceptions in nested parallel calls: the first one is what is seen, and no call returns half done.
#include <atomic>
#include <doctest/doctest.h>
#include <stdexcept>
#include <vector>

#include "core/base/parallel.h"

using namespace msbvh;

namespace {

// Whether all of its bodies ran, where it returned.
bool whole_for() {
  std::vector<int> done(64);
  parallel_for(done.size(), [&](std::size_t i) { done[i] = 1; });
  for (const int d : done) {
    if (!d) return false;
  }
  return true;
}

bool whole_invoke() {
  int a = 0, b = 0;
  parallel_invoke([&] { a = 1; }, [&] { b = 1; });
  return a + b == 2;
}

}  // namespace

TEST_CASE("what is thrown beside a nested call is seen, and the call does not return half done") {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> half_done = 0, calls = 0;
    const auto work = [&] {
      for (int i = 0; i < 200; ++i) {
        half_done += !whole_for() + !whole_invoke();
        ++calls;
      }
    };
    const auto fail = [&] {
      for (int i = 0; i < 1'000'000 && calls < round; ++i) {
      }
      throw std::runtime_error("first");
    };
    Arena(4).execute([&] {
      CHECK_THROWS_WITH_AS(parallel_invoke(work, fail), "first", std::runtime_error);
      calls = 1000;
      CHECK_THROWS_WITH_AS(parallel_for(4, [&](std::size_t i) { i == 3 ? fail() : work(); }), "first",
                           std::runtime_error);
    });
    CHECK(half_done == 0);
  }
}

TEST_CASE("an arena asks for no more threads than there can be") {
  const unsigned most = Arena(0).threads();
  CHECK(Arena(1).threads() == 1);
  CHECK(Arena(most).threads() == most);
  CHECK(Arena(4096).threads() == most);
  CHECK(Arena(4'000'000'000).threads() == most);
}
