// What a tree is built over: references to triangles, to patches of grids, to fragments of either, to pieces
// of curves, to points, and to instances.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/box.h"
#include "core/geometry/curve_set.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/point_set.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {

// The box of an instance in the tree's space, at the controls of a track of its own. Conservative between
// them.
struct InstanceBounds {
  TrackForm form;
  std::vector<Box3f> controls;  // form.controls(); empty: nothing to hit
};

// What a reference to an instance stands for: all of it or, after re-braiding (core/bvh/rebraid.h), what its
// object has below one child of a node. The builder hands it on; core/bvh/layout.h knows what it says.
struct InstancePart {
  static constexpr std::uint8_t kWhole = 0xff;

  std::uint32_t instance = 0;
  std::uint32_t parent = 0;    // ChildRef::bits of the node in the object's tree ...
  std::uint32_t child = 0;     // ... and of its child
  std::uint8_t slot = kWhole;  // of the child in the node
  std::uint8_t form = 0;       // FormCode::bits of the child

  bool is_whole() const { return slot == kWhole; }
};

// Where a mesh's vertices were at the shutter's centre.
using RestPose = std::vector<Vec3f>;

// The geometry of one tree. Borrowed; ids are indices.
struct Primitives {
  std::span<const std::shared_ptr<const TriangleMesh>> meshes;
  std::span<const InstanceBounds> instances;  // of `parts`, which references to instances are indices of
  std::span<const std::shared_ptr<const GridMesh>> grids = {};
  std::span<const std::shared_ptr<const CurveSet>> curves = {};
  std::span<const std::shared_ptr<const PointSet>> points = {};
  std::span<const InstancePart> parts = {};
  // Refit: by mesh, the poses that fragments were cut from when the topology was built; empty for meshes
  // without fragments. Without any, fragments are cut from the meshes' own centre.
  std::span<const RestPose> rest = {};
  std::span<const std::shared_ptr<const GridMesh>> rest_grids = {};  // the same of grids: still, or null
  TimeSlice slice = {};         // the part of the shutter that the tree is for; "centre" means that part's
  bool whole_spans = false;     // curves are not cut to pieces: the builder takes no partial primitives
  bool indexed_leaves = false;  // all of triangles: BuildSettings::layout
  bool swept = false;           // boxes are those of the whole shutter, still (Builder::kSwept)
};

// A reference stands for a whole primitive or, after spatial splits, for a fragment of a triangle or patch.
// The fragment needs no storage of its own: it is the part of the primitive that lies in `box` at the
// shutter's centre. (The box is the tight one of the fragment, and fragment = triangle ∩ (boxes of all splits
// above), hence triangle ∩ box is the fragment again; a patch is the union of its triangles. A refit moves
// the fragment, but does not cut it anew: box and centre stay those of the frame in which the topology was
// built.)
struct Reference {
  Box3f box;                // at the shutter's centre, u = 0.5
  std::uint32_t owner = 0;  // mesh id, with a flag for other kinds; kInstanceOwner for an instance
  // Triangle or patch in the mesh, CurvePiece::code(), point, or position in Primitives::parts.
  std::uint32_t index = 0;

  static constexpr std::uint32_t kClippedFlag = 0x80000000u;  // a fragment
  static constexpr std::uint32_t kGridFlag = 0x40000000u;
  static constexpr std::uint32_t kCurveFlag = 0x20000000u;
  static constexpr std::uint32_t kPointFlag = 0x10000000u;
  static constexpr std::uint32_t kInstanceOwner = 0x7fffffffu;

  std::uint32_t mesh() const { return owner & ~kClippedFlag; }
  std::uint32_t grid_mesh() const { return owner & ~(kClippedFlag | kGridFlag); }
  bool is_instance() const { return owner == kInstanceOwner; }
  bool is_grid() const { return (owner & kGridFlag) != 0 && !is_instance(); }
  bool is_curve() const { return (owner & kCurveFlag) != 0 && !is_instance(); }
  bool is_point() const { return (owner & kPointFlag) != 0 && !is_instance(); }
  bool is_round() const { return (owner & (kCurveFlag | kPointFlag)) != 0 && !is_instance(); }
  std::uint32_t round_set() const { return owner & ~(kCurveFlag | kPointFlag); }
  bool may_be_cut() const { return (owner & (kCurveFlag | kPointFlag)) == 0; }  // an instance has them all
  bool is_clipped() const { return (owner & kClippedFlag) != 0; }
};

// Of a curve's piece or a point (is_round()), at a control of its own track, and at a time.
Box3f round_box(const Primitives& primitives, const Reference& reference, std::uint32_t control);
Box3f round_box_at(const Primitives& primitives, const Reference& reference, float u);

// How what the reference stands for moves.
TrackForm form_of(const Primitives& primitives, const Reference& reference);
// How the nodes above it bound it: in the same form, still where primitives are swept, and in the time of the
// slice where there is one.
TrackForm node_form_of(const Primitives& primitives, const Reference& reference);

// The triangle at the shutter's centre, of the frame that fragments were cut in; in double for clipping (each
// float is exact in it).
template <typename T>
std::array<Vec3<T>, 3> centre_triangle(const Primitives& primitives, const Reference& reference) {
  const float centre = primitives.slice.time(0.5f);
  const TriangleMesh& mesh = *primitives.meshes[reference.mesh()];
  const Triangle& t = mesh.triangles[reference.index];
  if (!primitives.rest.empty()) {
    const RestPose& rest = primitives.rest[reference.mesh()];
    return {Vec3<T>(rest[t[0]]), Vec3<T>(rest[t[1]]), Vec3<T>(rest[t[2]])};
  }
  return {Vec3<T>(mesh.position(t[0], centre)), Vec3<T>(mesh.position(t[1], centre)),
          Vec3<T>(mesh.position(t[2], centre))};
}

}  // namespace msbvh
