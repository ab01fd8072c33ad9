// What a frame's rays cost: a fixed-seed sample of its own paths, traced again by kernels that count, in all
// and by the geometry that they tested.
//
// Counts are those of rays that go one after another. A frame's rays mostly go many at once, which tests the
// same leaves at least and some nodes more or fewer (core/trace/packets-inl.h, stream-inl.h).
//
// Shares are a model of the time that rays take, not a measurement: every node, block, and way into an
// instance has one price (core/cost/cost_model.h), wherever it lies in memory. They hold the rays' traversal
// alone: generating paths, textures, lights and shading, and the film are left out. And they
// say where rays spend their time, not what a frame without the prim would save: rays that bounce off it, and
// their shadow rays, fall away with it, and rays that it stopped go on to what lies behind it.
// Finely cut prims that coherent rays meet come out too dear, up to twofold. docs/design/ray_costs.md holds
// shares against measured times.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/build/settings.h"
#include "core/geometry/geometry_id.h"
#include "core/integrate/frame.h"
#include "core/plan/effect_plan.h"
#include "core/trace/tracer.h"

namespace msbvh {

struct RayCostSettings {
  // Of the frame's width * height * spp camera samples about so many, spread evenly over the image: time
  // grows with them, and the noise of shares falls with their square root. At least 1.
  std::uint64_t camera_samples = 20'000;
};

// Of one geometry of the scene, whatever shows it: instances are the geometry's that they show.
struct PrimCosts {
  std::string path;       // of the prim
  GeometryId geometry{};  // in the Scene
  // Sums over the rays; nodes and instances in fractions, since what stands above several geometries is
  // split among them (CostTally::add).
  double nodes = 0.0, instances = 0.0;
  std::uint64_t blocks = 0, primitives = 0;
  double share = 0.0;  // of all rays' cost
  // Of the seconds that building the trees took (SceneOwners::build_seconds); all are 0 where none was built.
  // In contrast to all else it is measured, and differs from run to run where there are several trees.
  double build_share = 0.0;
  double tree_bytes = 0.0;  // of those that the trees hold (SceneOwners::tree_bytes)
};

struct RayCosts {
  std::uint64_t paths = 0;       // camera samples traced again
  TraceCounts all;               // camera, bounce and shadow rays
  TraceCounts camera;            // of them, those from the camera
  double cost = 0.0;             // of all of them, in tests of a still node, by the model
  std::vector<PrimCosts> prims;  // all of the scene's geometry, in the order of Scene's lists
  double empty_nodes = 0.0;      // of rays that got to nobody's own nodes
  double empty_share = 0.0;      // theirs; with the prims' shares 1, or all are 0 where nothing costs
};

// Finished share in [0, 1], from the calling thread; false cancels.
using RayCostProgress = std::function<bool(double)>;

// `frame` is a frame whose tracer logs (Tracer::logging), without AOVs; `spp`: the samples that a pixel of it
// has. Uses the threads of the calling arena; the same on any number of them. Throws Cancelled.
RayCosts ray_costs(const Frame& frame, const BuildSettings& build, std::uint32_t spp,
                   const RayCostSettings& settings, const RayCostProgress& progress = {});

}  // namespace msbvh
