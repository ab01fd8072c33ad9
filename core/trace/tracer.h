// Traversal of a Bvh by the kernel that its content and this machine call for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/trace/ray.h"

namespace msbvh {

class Bvh;
struct RayLog;      // core/trace/ray_log.h
struct TraceVisit;  // core/trace/trace_visit.h

// Compiled in; which of them run is decided at run time. kAvx3 is AVX-512 as of Skylake, used at 256 bits.
enum class InstructionSet : std::uint8_t { kSse4, kAvx2, kAvx3 };

std::vector<InstructionSet> supported_instruction_sets();  // on this machine, worst first, never empty
const char* instruction_set_name(InstructionSet set);      // "sse4", "avx2", "avx3"

// What one or many rays cost. Counted only by the counting entry points, which run kernels of their own.
struct TraceCounts {
  std::uint64_t rays = 0;
  std::uint64_t nodes = 0;       // 8-wide nodes, and windows of grids, whose boxes were tested
  std::uint64_t blocks = 0;      // leaf blocks of up to 8 primitives, and tiles of grids, tested
  std::uint64_t primitives = 0;  // triangles, spans of curves and points in them
  std::uint64_t instances = 0;   // instances entered
  // Where not null: each of these one by one, in the order in which the ray met them.
  std::vector<TraceVisit>* visits = nullptr;

  void add(const TraceVisit& visit);
  // The visits of `other` are its own.
  TraceCounts& operator+=(const TraceCounts& other) {
    rays += other.rays;
    nodes += other.nodes;
    blocks += other.blocks;
    primitives += other.primitives;
    instances += other.instances;
    return *this;
  }
};

// How many rays went in which way.
struct TraceModes {
  std::uint64_t packets = 0;      // in packets of 16 that go down a tree together
  std::uint64_t interleaved = 0;  // many at once, each on its own way
  std::uint64_t single = 0;       // one after another
  RayLog* log = nullptr;          // where a logging Tracer writes; others do not read it

  std::uint64_t rays() const { return packets + interleaved + single; }
  TraceModes& operator+=(const TraceModes& other) {
    packets += other.packets;
    interleaved += other.interleaved;
    single += other.single;
    return *this;
  }
};

// Chooses the kernel once; cheap to copy. The Bvh must outlive it. Thread-safe.
class Tracer {
 public:
  // Uses the best supported instruction set.
  explicit Tracer(const Bvh& bvh);
  // Throws Error if the processor or the build does not support `set`.
  Tracer(const Bvh& bvh, InstructionSet set);
  // Gives the same answers, and writes each ray of those that are asked for many at once to the `log` of the
  // caller's TraceModes. For measurements: the ordinary Tracer has none of its instructions.
  static Tracer logging(const Bvh& bvh);

  // The closest hit in [tnear, tfar]; `hit` is written only where true is returned.
  bool intersect(const Ray& ray, Hit& hit) const { return intersect_(*bvh_, ray, hit, nullptr); }
  // The same for many rays, which need not be coherent: hits[i].found() says whether rays[i] has one. From
  // some dozens of rays on faster than one by one, and more so where the tree outgrows the caches, or where
  // neighbours among the rays look the same way. Hundreds at once and more let rays at like times meet.
  void intersect(std::span<const Ray> rays, Hit* hits) const {
    TraceModes modes;
    intersect(rays, hits, modes);
  }
  // Adds to `modes`.
  void intersect(std::span<const Ray> rays, Hit* hits, TraceModes& modes) const {
    intersect_many_(*bvh_, rays.data(), rays.size(), hits, modes);
  }
  // Whether anything lies in [tnear, tfar].
  bool occluded(const Ray& ray) const { return occluded_(*bvh_, ray, nullptr); }
  void occluded(std::span<const Ray> rays, bool* occluded) const {
    TraceModes modes;
    this->occluded(rays, occluded, modes);
  }
  void occluded(std::span<const Ray> rays, bool* occluded, TraceModes& modes) const {
    occluded_many_(*bvh_, rays.data(), rays.size(), occluded, modes);
  }

  bool intersect_counted(const Ray& ray, Hit& hit, TraceCounts& counts) const;
  bool occluded_counted(const Ray& ray, TraceCounts& counts) const;

 private:
  using IntersectFunction = bool (*)(const Bvh&, const Ray&, Hit&, TraceCounts*);
  using OccludedFunction = bool (*)(const Bvh&, const Ray&, TraceCounts*);

  const Bvh* bvh_;
  void (*intersect_many_)(const Bvh&, const Ray*, std::size_t, Hit*, TraceModes&);
  void (*occluded_many_)(const Bvh&, const Ray*, std::size_t, bool*, TraceModes&);
  IntersectFunction intersect_, intersect_counted_;
  OccludedFunction occluded_, occluded_counted_;
};

}  // namespace msbvh
