#include "core/build/make_references.h"

#include "core/build/reduce.h"
#include "core/build/round_references.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr std::size_t kTrianglesPerTask = 16384;
constexpr std::size_t kPatchesPerTask = 256;

Box3f reference_box(const Primitives& primitives, const InstanceBounds& bounds) {
  if (primitives.swept) {
    Box3f box;
    for (const Box3f& b : bounds.controls) box.grow(b);
    return box;
  }
  const SegmentTime at = locate(primitives.slice.time(0.5f), bounds.form.segments);
  return track_value(bounds.controls.data(), bounds.form, at.key, at.w);
}

Box4 swept_box(const TriangleMesh& mesh, const Triangle& triangle) {
  Box4 box;
  for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
    for (const std::uint32_t v : triangle) box.grow(load4(mesh.control_positions(c) + v));
  }
  return box;
}

SetBounds add_mesh(const CentrePose& pose, std::uint32_t mesh, Reference* out) {
  const TriangleMesh& shape = *pose.primitives().meshes[mesh];
  const std::vector<Triangle>& triangles = shape.triangles;
  const bool swept = pose.primitives().swept;
  const Vec3f* positions = pose.positions(mesh);
  return reduce_in_chunks<SetBounds>(
      triangles.size(), kTrianglesPerTask, [] { return SetBounds(); },
      [&](SetBounds& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Box4 box;
          for (const std::uint32_t v : triangles[i]) box.grow(load4(positions + v));
          if (swept) box = swept_box(shape, triangles[i]);
          sum.grow(box);
          out[i] = {box.box(), mesh, static_cast<std::uint32_t>(i)};
        }
      },
      [](SetBounds& sum, const SetBounds& part) { sum.grow(part); });
}

Box3f reference_box(const Primitives& primitives, const GridMesh& mesh, const GridPatch& patch) {
  Box3f box;
  if (primitives.swept || !mesh.form().moving()) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) box.grow(mesh.bounds(patch, c));
    return box;
  }
  const float centre = primitives.slice.time(0.5f);
  for (std::uint32_t r = 0; r <= patch.rows; ++r) {
    for (std::uint32_t c = 0; c <= patch.columns; ++c)
      box.grow(mesh.point(mesh.grids[patch.grid], patch.row + r, patch.column + c, centre));
  }
  return box;
}

SetBounds add_grids(const Primitives& primitives, std::uint32_t id, Reference* out) {
  const GridMesh& mesh = *primitives.grids[id];
  return reduce_in_chunks<SetBounds>(
      mesh.patches.size(), kPatchesPerTask, [] { return SetBounds(); },
      [&](SetBounds& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Box3f box = reference_box(primitives, mesh, mesh.patches[i]);
          sum.grow(Box4(box));
          out[i] = {box, id | Reference::kGridFlag, static_cast<std::uint32_t>(i)};
        }
      },
      [](SetBounds& sum, const SetBounds& part) { sum.grow(part); });
}

}  // namespace

AllReferences make_references(const CentrePose& pose) {
  const Primitives& primitives = pose.primitives();
  std::size_t capacity = primitives.instances.size();
  for (const auto& mesh : primitives.meshes) capacity += mesh->triangles.size();
  for (const auto& mesh : primitives.grids) capacity += mesh->patches.size();
  const std::vector<Reference> round = round_references(primitives);
  capacity += round.size();
  AllReferences all;
  all.memory = std::make_shared<RawArray<Reference>>(capacity);
  for (std::uint32_t m = 0; m < primitives.meshes.size(); ++m) {
    all.bounds.grow(add_mesh(pose, m, all.memory->data() + all.count));
    all.count += primitives.meshes[m]->triangles.size();
  }
  for (std::uint32_t m = 0; m < primitives.grids.size(); ++m) {
    all.bounds.grow(add_grids(primitives, m, all.memory->data() + all.count));
    all.count += primitives.grids[m]->patches.size();
  }
  for (const Reference& r : round) {
    all.bounds.grow(Box4(r.box));
    (*all.memory)[all.count++] = r;
  }
  for (std::uint32_t i = 0; i < primitives.instances.size(); ++i) {
    const InstanceBounds& bounds = primitives.instances[i];
    if (bounds.controls.empty()) continue;
    const Box3f box = reference_box(primitives, bounds);
    all.bounds.grow(Box4(box));
    (*all.memory)[all.count++] = {box, Reference::kInstanceOwner, i};
  }
  return all;
}

}  // namespace msbvh
