// The checks that validate(CurveSet) and validate(PointSet) share.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/round_vertex.h"
#include "core/motion/track.h"

namespace msbvh {

// Throw Error: `part` is what messages begin with.
void check_form(const TrackForm& form, const std::string& part);
// `count`: vertices at each control.
void check_vertices(const std::vector<RoundVertex>& vertices, const TrackForm& form, std::size_t count,
                    const std::string& part);

}  // namespace msbvh
