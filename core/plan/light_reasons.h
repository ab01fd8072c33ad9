// What a light calls for.
#pragma once

#include <vector>

#include "core/plan/effect_plan.h"

namespace msbvh {

// Each effect once at most. None of a light that never shines.
std::vector<Reason> light_reasons(const Light& light);

}  // namespace msbvh
