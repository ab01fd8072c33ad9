#include "core/bvh/time_split.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/build/topology.h"
#include "core/bvh/flatten.h"
#include "core/bvh/key_bounds.h"

namespace msbvh {
namespace {

std::size_t aligned(std::size_t bytes) {
  constexpr std::size_t kLine = AlignedBuffer::kAlignment;
  return (bytes + kLine - 1) / kLine * kLine;
}

// A slice's tree has been copied to `base` of the arena: the positions in its nodes follow.
ChildRef relocate(Bvh& bvh, ChildRef ref, std::size_t base) {
  ref.bits += static_cast<std::uint32_t>(base / kUnit);
  if (ref.is_leaf()) return ref;
  auto& node = *reinterpret_cast<NodeHeader*>(bvh.arena.data() + ref.offset());
  for (std::uint32_t i = 0; i < node.child_count; ++i) node.child[i] = relocate(bvh, node.child[i], base);
  return ref;
}

void join_arenas(Bvh& bvh, std::vector<Bvh>& slices) {
  std::size_t bytes = 0;
  for (const Bvh& slice : slices) bytes += aligned(slice.arena.size());
  if (bytes / kUnit >= ChildRef::kLeafFlag) {
    throw Error("accelerator: " + std::to_string(bytes) + " bytes in trees of " +
                std::to_string(slices.size()) + " time slices; expected less than 2^35");
  }
  bvh.arena = AlignedBuffer(bytes);
  std::memset(bvh.arena.data(), 0, bytes);
  std::size_t base = 0;
  for (Bvh& slice : slices) {
    std::memcpy(bvh.arena.data() + base, slice.arena.data(), slice.arena.size());
    bvh.slice_roots.push_back({relocate(bvh, slice.root, base), slice.root_form_code});
    bvh.still_parts |= slice.still_parts;
    base += aligned(slice.arena.size());
    slice.arena = {};
  }
  bvh.slice_level = level_of(static_cast<std::uint32_t>(slices.size()));
  bvh.root = bvh.slice_roots[0].ref;
  bvh.root_form_code = bvh.slice_roots[0].form;
}

// The box track over the whole shutter. Neighbours share a control, whose box holds that of both.
void join_bounds(Bvh& bvh, const std::vector<Bvh>& slices) {
  std::uint32_t degree = 1;
  for (const Bvh& slice : slices) degree = std::max(degree, slice.root_form.degree);
  bvh.root_form = {static_cast<std::uint32_t>(slices.size()), degree};
  bvh.root_bounds.assign(bvh.root_form.controls(), {});
  for (std::size_t s = 0; s < slices.size(); ++s) {
    grow_track(std::span(bvh.root_bounds).subspan(s * degree, degree + 1), {1, degree}, slices[s].root_bounds,
               slices[s].root_form);
  }
}

void join_statistics(Bvh& bvh, const std::vector<Bvh>& slices) {
  BvhStatistics& sum = bvh.statistics;
  for (const Bvh& slice : slices) sum += slice.statistics;
  sum.sah_cost /= static_cast<double>(slices.size());
  sum.vertex_bytes = slices[0].statistics.vertex_bytes;
}

}  // namespace

std::uint32_t finest_segments(const Bvh& bvh, std::span<const InstanceBounds> instances) {
  std::uint32_t finest = 0;
  for (const auto& mesh : bvh.meshes) {
    if (!mesh->triangles.empty()) finest = std::max(finest, mesh->segments);
  }
  for (const auto& mesh : bvh.grids) finest = std::max(finest, mesh->form().segments);
  for (const auto& set : bvh.curves) finest = std::max(finest, set->segments);
  for (const auto& set : bvh.points) finest = std::max(finest, set->segments);
  for (const InstanceBounds& bounds : instances) {
    if (!bounds.controls.empty()) finest = std::max(finest, bounds.form.segments);
  }
  return finest;
}

std::uint64_t build_time_split(Bvh& bvh, const InstanceParts& instances, std::uint32_t slices,
                               const BuildSettings& settings) {
  std::vector<Bvh> trees(slices);
  std::uint64_t references = 0;
  for (std::uint32_t i = 0; i < slices; ++i) {
    const Primitives primitives{.meshes = bvh.meshes,
                                .instances = instances.bounds,
                                .grids = bvh.grids,
                                .curves = bvh.curves,
                                .points = bvh.points,
                                .parts = instances.parts,
                                .slice = {i, slices},
                                .whole_spans = bvh.builder != Builder::kMsbvh,
                                .indexed_leaves = bvh.layout == TreeLayout::kCompact};
    Topology topology = build_topology(primitives, settings);
    flatten(primitives, topology, settings, trees[i]);
    references += topology.reference_count;
  }
  if (references == 0) return 0;  // points without radii, say: in no slice there is anything
  join_arenas(bvh, trees);
  join_bounds(bvh, trees);
  join_statistics(bvh, trees);
  bvh.empty = false;
  return references;
}

}  // namespace msbvh
