// What the stability bench traces: closed shapes in motions and at places that break renderers.
// Seeded: the same cell is the same scene on any machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/base/vec.h"
#include "core/motion/track.h"
#include "core/scene/scene.h"

namespace msbvh::bench {

struct StabilityShape {
  const char* name;
  const char* what;    // one line, for people
  bool curved_tracks;  // whether it can move on tracks of degree 2 and 3
};
std::span<const StabilityShape> stability_shapes();

struct StabilityMotion {
  const char* name;
  const char* what;
  Vec3d (*at)(const Vec3d& centre, double u);  // of a shape about 2 units across, around the origin
};
std::span<const StabilityMotion> stability_motions();

// The shape is 2 * scale across, around (position, position, -position). Never so far away that the shape is
// smaller than what single precision rounds there.
struct StabilityPlace {
  double position, scale;
};
std::span<const StabilityPlace> stability_places();
std::span<const TrackForm> stability_forms();  // 2, 9, 33 and 129 linear keys, two quadratics, two cubics

struct StabilityCell {
  std::string shape, motion;
  TrackForm form;
  StabilityPlace place;
};

// Throws Error for names that are unknown, and for a shape that cannot move so: is_measured() says which can.
bool is_measured(const StabilityCell& cell);
std::shared_ptr<const Scene> stability_scene(const StabilityCell& cell, std::uint32_t seed);

}  // namespace msbvh::bench
