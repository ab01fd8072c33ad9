#include "core/build/moving_set.h"

#include <algorithm>

#include "core/build/clip.h"
#include "core/build/grid_clip.h"

namespace msbvh {
namespace {

// So many references tell how a set moves ...
constexpr std::size_t kSample = 64;
// ... which is incoherent from this share of its area on (docs/design/build.md).
constexpr float kIncoherentGrowth = 1.2f;

Box3f box_at(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control) {
  const Vec3f* p = mesh.control_positions(control);
  Box4 box;
  for (const std::uint32_t v : triangle) box.grow(load4(p + v));
  return box.box();
}

Box3f fragment_at(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control,
                  const BarycentricPolygon& polygon) {
  const Vec3f* p = mesh.control_positions(control);
  const Vec3d v[3] = {Vec3d(p[triangle[0]]), Vec3d(p[triangle[1]]), Vec3d(p[triangle[2]])};
  Box3d box;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec3d& b = polygon.corners[i];
    box.grow(v[0] * b.x + v[1] * b.y + v[2] * b.z);
  }
  return {Vec3f(box.lo), Vec3f(box.hi)};
}

// A fragment's is that of the whole quads it lies in.
GridPatch window_of(const Primitives& primitives, const Reference& r) {
  return r.is_clipped() ? centre_patch(primitives, r).window(r.box)
                        : primitives.grids[r.grid_mesh()]->patches[r.index];
}

bool any_moves(const Primitives& primitives) {
  const auto moves = [](const auto& mesh) { return mesh->form().moving(); };
  return std::any_of(primitives.meshes.begin(), primitives.meshes.end(), moves) ||
         std::any_of(primitives.grids.begin(), primitives.grids.end(), moves) ||
         std::any_of(primitives.instances.begin(), primitives.instances.end(),
                     [](const InstanceBounds& b) { return b.form.moving(); });
}

}  // namespace

MeanArea::MeanArea(const Primitives& primitives) {
  const auto add = [this](const TrackForm& form) { one_segment_ &= form.controls() <= 2; };
  for (const auto& mesh : primitives.meshes) add(mesh->form());
  for (const auto& mesh : primitives.grids) add(mesh->form());
  for (const InstanceBounds& b : primitives.instances) add(b.form);
}

ShutterPose::ShutterPose(const CentrePose& pose)
    : pose_(pose), mean_area_(pose.primitives()), moving_(any_moves(pose.primitives())) {}

MovingReference ShutterPose::at_ends(const Reference& r) const {
  const Primitives& primitives = pose_.primitives();
  if (r.is_instance()) {
    const InstanceBounds& b = primitives.instances[r.index];
    return {r, b.controls.front(), b.controls.back()};
  }
  if (!form_of(primitives, r).moving()) return {r, r.box, r.box};
  if (r.is_grid()) {
    const GridMesh& mesh = *primitives.grids[r.grid_mesh()];
    const GridPatch window = window_of(primitives, r);
    return {r, mesh.bounds(window, 0), mesh.bounds(window, mesh.form().controls() - 1)};
  }
  const TriangleMesh& mesh = *primitives.meshes[r.mesh()];
  const Triangle& triangle = mesh.triangles[r.index];
  const std::uint32_t last = mesh.form().controls() - 1;
  if (r.is_clipped()) {
    const BarycentricPolygon polygon = clip_to_box(pose_.triangle(r), r.box);
    if (polygon.count > 0)
      return {r, fragment_at(mesh, triangle, 0, polygon), fragment_at(mesh, triangle, last, polygon)};
  }
  return {r, box_at(mesh, triangle, 0), box_at(mesh, triangle, last)};
}

bool ShutterPose::incoherent(std::span<const Reference> references) const {
  ShutterBox box;
  const std::size_t stride = std::max<std::size_t>(1, references.size() / kSample);
  for (std::size_t i = 0; i < references.size(); i += stride) box.grow(ShutterBox(at_ends(references[i])));
  return mean_area_(box) > kIncoherentGrowth * half_area(box.centre);
}

}  // namespace msbvh
