// The scenes of the stability bench. Seeded: the same cell is the same scene on any machine.
#pragma once

#include <cstdint>
#include <memory>

#include "bench/stability_cells.h"
#include "core/scene/scene.h"

namespace msbvh::bench {

// Throws Error for names that are unknown, and for a cell that is not measured.
std::shared_ptr<const Scene> stability_scene(const StabilityCell& cell, std::uint32_t seed);

}  // namespace msbvh::bench
