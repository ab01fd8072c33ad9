#include "core/probe/tracer_under_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/parallel.h"

namespace msbvh {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr std::size_t kRaysPerTask = 1u << 10;  // whole packets of any width

enum OurWay : std::size_t { kOne, kMany, kAnyHitOfOne, kAnyHitOfMany };

}  // namespace

const std::vector<std::string>& OurTracerUnderTest::ways() const {
  static const std::vector<std::string> names{"one", "many", "one, any hit", "many, any hit"};
  return names;
}

void OurTracerUnderTest::closest(std::size_t way, std::span<const Ray> rays, float* t) const {
  std::vector<Hit> hits(way == kMany ? rays.size() : 1);
  const auto occluded = std::make_unique<bool[]>(way == kAnyHitOfMany ? rays.size() : 0);
  if (way == kMany) tracer_.intersect(rays, hits.data());
  if (way == kAnyHitOfMany) tracer_.occluded(rays, occluded.get());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (way == kOne) {
      t[i] = tracer_.intersect(rays[i], hits[0]) ? hits[0].t : kNothing;
    } else if (way == kMany) {
      t[i] = hits[i].found() ? hits[i].t : kNothing;
    } else {
      t[i] = (way == kAnyHitOfOne ? tracer_.occluded(rays[i]) : occluded[i]) ? 0.0f : kNothing;
    }
  }
}

std::vector<std::size_t> lost_rays(const TracerUnderTest& tracer, std::size_t way,
                                   std::span<const Ray> rays) {
  std::vector<float> t(rays.size());
  parallel_for_ranges(t.size(), kRaysPerTask, [&](std::size_t begin, std::size_t end) {
    tracer.closest(way, rays.subspan(begin, end - begin), t.data() + begin);
  });
  std::vector<std::size_t> lost;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::isinf(t[i])) lost.push_back(i);
  }
  return lost;
}

}  // namespace msbvh
