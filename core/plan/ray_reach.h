// How far the rays of a frame go.
#pragma once

#include <cstdint>

#include "core/scene/scene.h"

namespace msbvh {

// Whether there is light to be found: lamps that are not black, or a surface that glows.
bool anything_shines(const Scene& scene);

// Whether rays go anywhere but from the camera: to lights that cast shadows, or, with bounces, on in search
// of light. Where they do not, only what camera rays meet is seen. Opacity lets camera rays go on, and is no
// ray of its own.
bool goes_beyond_camera_rays(const Scene& scene, std::uint32_t max_bounces);

}  // namespace msbvh
