// What the stability bench tries: shapes, in motions, on tracks and at places that break renderers. A cell is
// one of each; most combinations are cells, is_measured() says which.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/motion/track.h"

namespace msbvh::bench {

// Which rays a shape is asked.
enum class StabilityProbe : std::uint8_t {
  kInside,       // from inside of a closed mesh: core/probe/inside_rays.h
  kInsidePlain,  // of them those in any direction at any time alone
  kIntoRound     // into tubes and spheres: core/probe/round_rays.h
};

struct StabilityShape {
  const char* name;
  const char* what;    // one line, for people
  bool curved_tracks;  // whether it can move on tracks of degree 2 and 3
  StabilityProbe probe = StabilityProbe::kInside;
};
std::span<const StabilityShape> stability_shapes();

struct StabilityMotion {
  const char* name;
  const char* what;
  Vec3d (*at)(const Vec3d& centre, double u);  // of a shape about 2 units across, around the origin
  bool degenerate = false;                     // triangles, or the whole shape, have no area at some time
};
std::span<const StabilityMotion> stability_motions();

// The shape is 2 * scale across, around (position, position, -position). Never so far away that the shape is
// smaller than what single precision rounds there.
struct StabilityPlace {
  double position, scale;
  bool operator==(const StabilityPlace&) const = default;
};

struct StabilityCell {
  std::string shape, motion;
  TrackForm form;
  StabilityPlace place;
};

// All that are measured, in order: every shape at each motion, form and place that it has.
std::vector<StabilityCell> stability_cells();

// Throw Error for names that are unknown.
const StabilityShape& stability_shape(const std::string& name);
const StabilityMotion& stability_motion(const std::string& name);
bool is_measured(const StabilityCell& cell);

}  // namespace msbvh::bench
