// The interface that another ray tracer is measured through. A peer is a shared library of its own, loaded at
// run time: neither the extension nor the library links against it.
//
//   extern "C" std::uint32_t msbvh_peer_abi();                // kPeerAbi
//   extern "C" const char* msbvh_peer_open(const char* dir);  // loads the ray tracer from there; null, or
//   what failed extern "C" const char* msbvh_peer_name();                 // "Embree 4.4.0 (AVX-512)"; after
//   msbvh_peer_open extern "C" const char* const* msbvh_peer_modes();         // names, then null extern "C"
//   msbvh::bench::Peer* msbvh_peer_make(const msbvh::bench::PeerScene&, unsigned threads, bool robust);
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/affine.h"
#include "core/geometry/round_vertex.h"
#include "core/trace/ray.h"

namespace msbvh::bench {

inline constexpr std::uint32_t kPeerAbi = 3;

// All borrowed for the life of the peer. Linear keys, evenly spaced over the shutter.
struct PeerMesh {
  const Vec3f* positions;  // [keys][vertices], readable for 16 bytes at the last one
  std::uint32_t keys, vertices;
  const std::uint32_t* triangles;  // [count][3]
  std::uint32_t triangle_count;
};
// Cubic Bezier spans, or spheres.
struct PeerRound {
  enum class Kind : std::uint8_t { kRibbons, kTubes, kSpheres } kind;
  const RoundVertex* vertices;  // [keys][vertex_count]
  std::uint32_t keys, vertex_count;
  const std::uint32_t* firsts;  // of the four vertices of each span; null for spheres
  std::uint32_t span_count;
};
struct PeerObject {
  std::vector<PeerMesh> meshes;
  std::vector<PeerRound> round;
};
struct PeerInstance {
  std::uint32_t object;
  std::uint32_t keys;
  const Affine3f* world_from_object;  // [keys]
};
struct PeerScene {
  PeerObject world;
  std::vector<PeerObject> objects;
  std::vector<PeerInstance> instances;
};

// A range that begins or ends within a set of rays does so at a multiple of this.
inline constexpr std::size_t kPeerPacket = 16;

// Rays in the peer's own layouts.
class PeerRays {
 public:
  virtual ~PeerRays() = default;
};

class Peer {
 public:
  virtual ~Peer() = default;
  virtual void build() = 0;  // once
  // All that traversal reads: what the library holds after the build, and moving vertices, which its leaves
  // index.
  virtual std::uint64_t bytes() const = 0;
  // Outside of the clock: a renderer would write its rays in this layout in the first place.
  virtual std::unique_ptr<PeerRays> prepare(const Ray* rays, std::size_t count) const = 0;
  // t of the closest hits of rays begin .. end - 1, infinity where there is none; for occlusion 0 or
  // infinity. `mode` is a place in msbvh_peer_modes().
  virtual void intersect(std::size_t mode, const PeerRays&, std::size_t begin, std::size_t end,
                         float* t) const = 0;
  virtual void occluded(std::size_t mode, const PeerRays&, std::size_t begin, std::size_t end,
                        float* t) const = 0;
};

}  // namespace msbvh::bench
