// What must hold of a tree, whatever it was built from.
#pragma once

#include <cstdint>

#include "core/api/accel.h"
#include "tests/fuzz/fuzzed_data.h"

namespace msbvh::fuzz {

// verify(), and rays in the tree's box held against the oracle; many at once equal one by one.
void check_tree(const Accel& accel, FuzzedData& data, std::uint32_t rays);

}  // namespace msbvh::fuzz
