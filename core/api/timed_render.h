// A frame whose samples come in passes, until a time is over.
#pragma once

#include <cstdint>
#include <functional>

#include "core/api/renderer.h"
#include "core/integrate/pixel_area.h"

namespace msbvh {

struct TimedPicture {
  Image image;
  // Of each pixel, or the most where noise decides: with so many settings.spp is the same picture, to the
  // bit.
  std::uint32_t samples = 0;
  StageCounts stages;  // of settings.sample_stages
};

// `empty`: of the size and with the layers of what is rendered; settings.spp are the samples that are wanted
// at most. A pass that is not over when `seconds` are is dropped; the first, of a block of samples, is always
// finished. Keeps the sums of all pixels: 64 bytes a pixel at powers of two of samples and more between them,
// where more nodes of their trees are whole; about 300 where noise decides, about a thousand with all AOVs.
// Throws Cancelled.
TimedPicture render_timed(const Frame& frame, const RenderSettings& settings, double seconds,
                          const Image& empty, const ProgressFunction& progress, AreaTraced& traced);

}  // namespace msbvh
