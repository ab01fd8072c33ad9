// A scene as a peer takes it: linear keys at even times. Curves and time remaps of ours are sampled.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "bench/peer.h"
#include "core/scene/scene.h"

namespace msbvh::bench {

struct PeerInput {
  PeerScene scene;
  std::uint32_t keys = 1;  // the most of any track
  bool sampled = false;    // some track is a curve or has a time remap: hit distances differ by design
  double error = 0.0;      // the largest deviation found of a sampled track
  std::string missing;     // what the peer cannot show; not empty: it is not measured
  // What was sampled; deques keep their elements in place.
  std::deque<std::vector<Vec3f>> positions;
  std::deque<std::vector<Affine3f>> maps;
  std::deque<TriangleMesh> meshes;  // what grids are
};

// Sampled tracks get the fewest of 2, 3, 5, ... 129 keys that stay within `tolerance` of ours. Borrows from
// `scene` and from itself.
void fill_peer_input(const Scene& scene, double tolerance, PeerInput& out);

}  // namespace msbvh::bench
