// Random numbers of the probes: the same on every machine for a seed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "core/base/box.h"
#include "core/base/vec.h"

namespace msbvh {

class ProbeRandom {
 public:
  explicit ProbeRandom(std::uint64_t seed) : engine_(seed) {}

  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  Vec3d in_box(const Box3d& box) {
    const double x = uniform(box.lo.x, box.hi.x), y = uniform(box.lo.y, box.hi.y);
    return {x, y, uniform(box.lo.z, box.hi.z)};
  }
  // On the unit sphere, evenly.
  Vec3d direction() {
    const double z = uniform(-1.0, 1.0), around = uniform(0.0, 6.283185307179586);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(around), r * std::sin(around), z};
  }
  // A time of the shutter: any, or where motion is likeliest to be read wrongly: at a key, and next to one.
  float time() {
    if (below(2) == 0) return static_cast<float>(uniform());
    const std::size_t segments = std::size_t(1) << below(8);
    const float key = static_cast<float>(below(segments + 1)) / static_cast<float>(segments);
    const float beside[] = {key, std::nextafter(key, 0.0f), std::nextafter(key, 1.0f)};
    return beside[below(3)];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace msbvh
