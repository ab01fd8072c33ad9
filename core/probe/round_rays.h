// Rays that a tube or a sphere must stop: each starts outside of everything and ends well inside of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

namespace msbvh {

// About `count` rays into the tree's own tubes and points; what its instances show is left alone. A ray ends
// at tfar = 1 in a point that is no farther from the centre (a tube's: from its centre line) than half the
// radius, while the other half is more than what a kernel rounds: one that hits nothing is lost. Of a tube
// that is a place away from the free ends, met from the side, so that it does not matter how a tracer closes
// them; where spans meet at a kink another tracer may leave a gap by its own definition. Fewer rays, or none,
// where no such place is found. Half of the times are at keys and next to them. The same for a seed.
std::vector<Ray> rays_into_round(const Bvh& world, std::size_t count, std::uint64_t seed);

}  // namespace msbvh
