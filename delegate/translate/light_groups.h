// Which lights reach what: light groups by the paths of prims.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

#include "core/scene/scene.h"

namespace msbvh::translate {

// One, or of what places instances one for each of their ids (InstanceSet::ids).
using LightGroups = std::unordered_map<std::string, std::vector<std::uint32_t>>;

// To geometry by its prim's path; to instances by that of what places them, which overrides their geometry's.
// What is not named, or has no group of its own, stays in group 0.
void assign_light_groups(const LightGroups& groups, Scene& scene);

}  // namespace msbvh::translate
