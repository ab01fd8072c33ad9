// The gate of one light.
#pragma once

#include <cstdint>
#include <string>

#include "core/scene/light.h"

namespace msbvh {

// `groups`: how many light groups geometry names. Throws Error naming `part`, the attribute, found and
// expected.
void check_light(const Light& light, std::uint32_t groups, const std::string& part);

}  // namespace msbvh
