// What the probes put to the test: rays in, distances out. Ours and another ray tracer's are asked alike.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/trace/ray.h"
#include "core/trace/tracer.h"

namespace msbvh {

class TracerUnderTest {
 public:
  virtual ~TracerUnderTest() = default;
  // Those in which it can be asked for the same hits: "one", "many", ...
  virtual const std::vector<std::string>& ways() const = 0;
  // For each ray t of the closest hit, infinity where there is none, in ways()[way]. Called from many threads
  // at once.
  virtual void closest(std::size_t way, std::span<const Ray> rays, float* t) const = 0;
};

// Ours by the kernels of one instruction set: one ray at a time, many at once, and what any-hit queries say
// of a ray, whose t is 0.
class OurTracerUnderTest : public TracerUnderTest {
 public:
  OurTracerUnderTest(const Bvh& world, InstructionSet set) : tracer_(world, set) {}
  const std::vector<std::string>& ways() const override;
  void closest(std::size_t way, std::span<const Ray> rays, float* t) const override;

 private:
  const Tracer tracer_;
};

// The indices of those of the rays that hit nothing, which for rays from inside of closed meshes are leaks.
std::vector<std::size_t> lost_rays(const TracerUnderTest& tracer, std::size_t way, std::span<const Ray> rays);

}  // namespace msbvh
