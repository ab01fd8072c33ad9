// Stage 3, continued: how light meets what rays have hit, by textures, primvars and reflections.
#pragma once

#include <span>
#include <vector>

#include "core/integrate/frame.h"
#include "core/integrate/material_reads.h"

namespace msbvh {

// Of hits that were found: how light meets what they hit. `widths`: of each ray's cone there. `order` is
// room.
void find_covers(const Frame& frame, std::span<const Ray> rays, std::span<const Hit> hits,
                 std::span<const float> widths, MaterialReads& reads, std::vector<std::uint64_t>& order,
                 std::vector<Cover>& covers);

// Of a shadow ray: the share that goes no further. All of it where it would be bent, and not arrive.
inline float shadow_share(const Cover& cover) { return cover.bends ? 1.0f : cover.chance; }

// Whether the ray goes no further; then `met` is how the surface is shaded. What bends light takes all of it.
inline bool ends_there(const Cover& found, bool passes, Cover& met) {
  if (passes && !found.bends) return false;
  met = found;
  met.bends = passes;
  return true;
}

// Of one hit on a surface whose opacity (rendered) is below 1, by what was read of its material.
Cover cover_at(const Frame& frame, const Material& material, const MaterialHit& hit, float opacity,
               const MaterialReads& reads, std::size_t i);

}  // namespace msbvh
