#include "core/build/reference.h"

#include "core/base/parallel.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr float kCentre = 0.5f;
constexpr std::size_t kTrianglesPerTask = 16384;
constexpr std::size_t kPatchesPerTask = 256;

Box3f centre_box(const InstanceBounds& bounds) {
  const SegmentTime at = locate(kCentre, bounds.form.segments);
  return track_value(bounds.controls.data(), bounds.form, at.key, at.w);
}

Box3f centre_box(const TriangleMesh& mesh, const Triangle& triangle) {
  Box3f box;
  for (const std::uint32_t v : triangle) box.grow(mesh.position(v, kCentre));
  return box;
}

Box3f centre_box(const GridMesh& mesh, const GridPatch& patch) {
  if (!mesh.form().moving()) return mesh.bounds(patch, 0);
  Box3f box;
  for (std::uint32_t r = 0; r <= patch.rows; ++r) {
    for (std::uint32_t c = 0; c <= patch.columns; ++c)
      box.grow(mesh.point(mesh.grids[patch.grid], patch.row + r, patch.column + c, kCentre));
  }
  return box;
}

}  // namespace

std::vector<Reference> make_references(const Primitives& primitives) {
  std::size_t count = 0;
  for (const auto& mesh : primitives.meshes) count += mesh->triangles.size();
  for (const auto& mesh : primitives.grids) count += mesh->patches.size();
  std::vector<Reference> references(count);
  std::size_t first = 0;
  for (std::uint32_t m = 0; m < primitives.meshes.size(); ++m) {
    const TriangleMesh& mesh = *primitives.meshes[m];
    parallel_for_ranges(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        references[first + i] = {centre_box(mesh, mesh.triangles[i]), m, static_cast<std::uint32_t>(i)};
      }
    });
    first += mesh.triangles.size();
  }
  for (std::uint32_t m = 0; m < primitives.grids.size(); ++m) {
    const GridMesh& mesh = *primitives.grids[m];
    parallel_for_ranges(mesh.patches.size(), kPatchesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        references[first + i] = {centre_box(mesh, mesh.patches[i]), m | Reference::kGridFlag,
                                 static_cast<std::uint32_t>(i)};
      }
    });
    first += mesh.patches.size();
  }
  for (std::uint32_t i = 0; i < primitives.instances.size(); ++i) {
    const InstanceBounds& bounds = primitives.instances[i];
    if (!bounds.controls.empty()) {
      references.push_back({centre_box(bounds), Reference::kInstanceOwner, i});
    }
  }
  return references;
}

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  if (reference.is_instance()) return primitives.instances[reference.index].form;
  if (reference.is_grid()) return primitives.grids[reference.grid_mesh()]->form();
  return primitives.meshes[reference.mesh()]->form();
}

}  // namespace msbvh
