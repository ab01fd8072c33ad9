#include "core/bvh/refit.h"

#include <algorithm>
#include <cstring>

#include "core/geometry/curve_piece.h"

namespace msbvh {
namespace {

template <typename T>
bool same_bytes(const T* a, const T* b, std::size_t count) {
  return a == b || count == 0 || std::memcmp(a, b, count * sizeof(T)) == 0;
}

bool same_triangles(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles.size() == b.triangles.size() &&
         same_bytes(a.triangles.data(), b.triangles.data(), a.triangles.size());
}

// Positions first: those of a deformed mesh differ early.
bool same_mesh(const TriangleMesh& a, const TriangleMesh& b) {
  return a.form() == b.form() && a.vertex_count == b.vertex_count &&
         same_bytes(a.positions.data(), b.positions.data(), a.position_count()) && same_triangles(a, b);
}

bool same_patches(const GridMesh& a, const GridMesh& b) {
  const auto same_size = [](const Grid& x, const Grid& y) {
    return x.rows == y.rows && x.columns == y.columns;
  };
  return std::ranges::equal(a.grids, b.grids, same_size) && a.patches == b.patches;
}

// Of the same form, grids of the same sizes keep their values in the same places.
bool same_grids(const GridMesh& a, const GridMesh& b) {
  return a.form() == b.form() && a.values.size() == b.values.size() &&
         same_bytes(a.values.data(), b.values.data(), a.values.size()) && same_patches(a, b);
}

// The vertices, as a tree reads them.
template <typename Set>
bool same_round(const Set& a, const Set& b) {
  return a.form() == b.form() && a.vertices == b.vertices;
}
bool same_curves(const CurveSet& a, const CurveSet& b) {
  return same_round(a, b) && a.shape == b.shape && a.normals == b.normals && a.spans == b.spans &&
         a.loops == b.loops;
}

// The same parts to refer to. What has no width has no reference.
bool same_spans(const CurveSet& a, const CurveSet& b) {
  if (a.spans != b.spans) return false;
  for (std::uint32_t i = 0; i < a.span_count(); ++i) {
    if (is_there(a, i) != is_there(b, i)) return false;
  }
  return true;
}
bool same_points(const PointSet& a, const PointSet& b) {
  if (a.point_count != b.point_count) return false;
  for (std::uint32_t i = 0; i < a.point_count; ++i) {
    if (is_there(a, i) != is_there(b, i)) return false;
  }
  return true;
}

template <typename Sets, typename Same>
bool all_sets(const Sets& a, const Sets& b, const Same& same) {
  return std::ranges::equal(a, b, [&](const auto& x, const auto& y) { return same(*x, *y); });
}

template <typename Same>
bool all_meshes(const Bvh& a, const Bvh& b, const Same& same) {
  return std::ranges::equal(a.meshes, b.meshes, [&](const auto& x, const auto& y) { return same(*x, *y); });
}

template <typename Same>
bool all_grids(const Bvh& a, const Bvh& b, const Same& same) {
  return std::ranges::equal(a.grids, b.grids, [&](const auto& x, const auto& y) { return same(*x, *y); });
}

// A kept tree shares the arena of the one that it was kept from.
bool same_object(const Bvh& a, const Bvh& b) {
  return a.arena.data() == b.arena.data() && a.empty == b.empty && a.time_remap == b.time_remap;
}

bool same_instances(const Bvh& a, const Bvh& b) {
  return std::ranges::equal(a.instances, b.instances,
                            [](const Instance& x, const Instance& y) {
                              return x.form == y.form && x.time_remap == y.time_remap &&
                                     x.first_control == y.first_control && same_object(*x.object, *y.object);
                            }) &&
         a.instance_controls.size() == b.instance_controls.size() &&
         same_bytes(a.instance_controls.data(), b.instance_controls.data(), a.instance_controls.size());
}

}  // namespace

bool is_unchanged(const Bvh& previous, const Bvh& next, Builder builder) {
  return previous.builder == builder && previous.layout == next.layout &&
         previous.time_remap == next.time_remap && previous.time_remaps == next.time_remaps &&
         same_instances(previous, next) && all_meshes(previous, next, same_mesh) &&
         all_grids(previous, next, same_grids) && all_sets(previous.curves, next.curves, same_curves) &&
         all_sets(previous.points, next.points, same_round<PointSet>);
}

bool can_refit(const Bvh& previous, const KeptTopology& topology, const Bvh& next, Builder builder) {
  const auto same = [](const Instance& x, const Instance& y) { return same_object(*x.object, *y.object); };
  const bool braided = !std::ranges::all_of(topology.parts, &InstancePart::is_whole);
  return previous.builder == builder && previous.layout == next.layout &&
         previous.instances.size() == next.instances.size() &&
         (!braided || std::ranges::equal(previous.instances, next.instances, same)) &&
         all_meshes(previous, next, same_triangles) && all_grids(previous, next, same_patches) &&
         all_sets(previous.curves, next.curves, same_spans) &&
         all_sets(previous.points, next.points, same_points);
}

bool is_there(const KeptTopology& topology, std::span<const InstanceBounds> next_parts) {
  const auto there = [](const InstanceBounds& b) { return !b.controls.empty(); };
  return std::ranges::equal(topology.there, next_parts, {}, {}, there);
}

Bvh kept_tree(const Bvh& previous, Bvh next) {
  Bvh kept = previous;
  kept.meshes = std::move(next.meshes);
  kept.grids = std::move(next.grids);
  kept.curves = std::move(next.curves);
  kept.points = std::move(next.points);
  kept.instances = std::move(next.instances);
  BvhStatistics& s = kept.statistics;
  s.build_seconds = s.topology_seconds = s.bounds_seconds = s.refit_seconds = 0.0;
  s.built = s.refitted = 0;
  s.kept = 1;
  return kept;
}

}  // namespace msbvh
