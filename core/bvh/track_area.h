// How large a moving box is to the SAH.
#pragma once

#include <span>

#include "core/base/box.h"
#include "core/motion/track.h"

namespace msbvh {

// The area of the moving box, averaged over the shutter, by quadrature that is exact for it: on each segment
// it is a polynomial of twice the track's degree. Half areas, as half_area().
double mean_half_area(std::span<const Box3f> controls, const TrackForm& form);

}  // namespace msbvh
