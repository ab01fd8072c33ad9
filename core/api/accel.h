// The acceleration structure on its own: add meshes with their keys, commit, trace. Needs no USD and no
// renderer.
//
//   msbvh::Accel accel;
//   accel.add_mesh(mesh);            // core/geometry/triangle_mesh.h
//   accel.commit();
//   msbvh::Hit hit;
//   if (accel.intersect({.org = o, .dir = d, .time = 0.25f}, hit)) ...
//
// MSBVH: L. Gruenschloss, M. Stich, S. Nawaz, A. Keller, "MSBVH: An Efficient Acceleration Data Structure for
// Ray Traced Motion Blur", HPG 2011.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/affine.h"
#include "core/build/settings.h"
#include "core/bvh/statistics.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"
#include "core/trace/ray.h"

namespace msbvh {

class Bvh;  // core/bvh/bvh.h
struct BvhInput;
struct CurveSet;  // core/geometry/curve_set.h
struct GridMesh;  // core/geometry/grid_mesh.h
struct PointSet;  // core/geometry/point_set.h

class Accel {
 public:
  Accel();
  ~Accel();
  Accel(Accel&&) noexcept;
  Accel& operator=(Accel&&) noexcept;

  // Both return ids, counted from 0 in the order of the calls, meshes and instances apart. Throw Error for
  // geometry that is not valid (see validated()), for a non-finite matrix, and after commit().
  std::uint32_t add_mesh(TriangleMesh mesh);
  // Shares a mesh that has passed validate(), guard included, and does not look at it again.
  std::uint32_t add_mesh(std::shared_ptr<const TriangleMesh> mesh);
  // Grids of points, two triangles a quad, as displaced subdivision patches become
  // (core/geometry/subdivision/dice.h). The tree refers to patches of them. Ids are counted apart; a hit's
  // geometry says which kind it is of.
  std::uint32_t add_grids(GridMesh mesh);
  // Shares grids that have passed validate(), and does not look at them again.
  std::uint32_t add_grids(std::shared_ptr<const GridMesh> mesh);
  // Curves, flat and turned to the ray. A hit's triangle is the span, u the place along it, v that across.
  std::uint32_t add_curves(CurveSet curves);
  // Shares curves that have passed validate(), and does not look at them again.
  std::uint32_t add_curves(std::shared_ptr<const CurveSet> curves);
  // Points as spheres. A hit's triangle is the point.
  std::uint32_t add_points(PointSet points);
  std::uint32_t add_points(std::shared_ptr<const PointSet> points);
  // Instances of another, committed Accel that holds no instances itself (two levels). `world_from_object`
  // holds form.controls() maps for each instance, instance-major; `time_remap` says when they are there and
  // what time their tracks are read at. Returns the id of the first one.
  std::uint32_t add_instances(std::shared_ptr<const Accel> object, const TrackForm& form,
                              std::span<const Affine3f> world_from_object, const TimeRemap& time_remap = {});
  // The time of this Accel's own tracks where it is an instanced object. Before commit().
  void set_time_remap(const TimeRemap& time_remap);

  // Builds. Once; the Accel does not change afterwards. Uses the threads of the calling TBB arena.
  // Throws Cancelled if settings.cancelled says so, and leaves the Accel uncommitted.
  void commit(const BuildSettings& settings = {});
  // The same for the next frame of what `previous` holds, which may spare the build: settings.refit says what
  // is taken over, statistics() what was. Unchanged geometry keeps its tree, which is then shared. Where
  // meshes have the same triangles as before, and instances are as many, the topology that `previous` has (it
  // was committed with keep_topology) is evaluated at the new keys. It is handed on: `previous` traces as
  // before, but a second commit_from() it finds none. Hits equal those of commit(), but for which of two
  // triangles at the same distance rounding puts first.
  void commit_from(Accel& previous, const BuildSettings& settings = {});

  // Rays at any time, from any thread. See Tracer for a chosen instruction set and for counting. These and
  // all below throw Error before commit(), and after one that threw.
  bool intersect(const Ray& ray, Hit& hit) const;
  bool occluded(const Ray& ray) const;
  // The same for many rays, coherent or not: faster from some dozens of rays on. As many hits as rays.
  void intersect(std::span<const Ray> rays, Hit* hits) const;
  void occluded(std::span<const Ray> rays, bool* occluded) const;

  const Bvh& bvh() const;
  const BvhStatistics& statistics() const;

  // Proves the invariants of the tree at every key (children in parents, fragments in leaves, every triangle
  // covered); throws Error naming the node and the invariant. Slow: for tests.
  void verify() const;

 private:
  struct Data;
  Data& data() const;             // throws Error for an Accel that was moved from
  BvhInput& open();               // what is built from; throws Error after commit()
  const Data& committed() const;  // throws Error before commit()
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
