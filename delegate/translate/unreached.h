// What of a scene no ray can reach.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace msbvh::translate {

enum class Unreached : std::uint8_t {
  kHidden,         // invisible throughout the shutter
  kOutsidePicture  // throughout the shutter, where rays go nowhere but from the camera
};

// A prim that is drawn, but is not in the scene.
struct LeftOut {
  std::string path;
  Unreached why = Unreached::kHidden;
  std::size_t count = 1;  // of instances
  // Of which it was: places in Scene::instances as they were before, and parts of Scene::world.
  std::vector<std::size_t> sets{};
  std::vector<GeometryId> world{};
};

// Takes out of a finished scene what no ray of a render in width x height pixels with so many bounces can
// reach: sets of instances that are hidden throughout the shutter and, where goes_beyond_camera_rays() says
// no (core/plan/ray_reach.h), geometry of the world and sets of instances wholly outside of the picture
// (view_volume.h). Bounces that are not known may reach all that is not hidden. Of geometry that nothing
// places any more an empty one of its name is left: AOVs number prims by their places. A set of which any
// instance may be seen stays whole, since AOVs number instances too. The picture keeps its bits.
std::vector<LeftOut> leave_out_unreached(Scene& scene, std::uint32_t width, std::uint32_t height,
                                         std::optional<std::uint32_t> max_bounces);

}  // namespace msbvh::translate
