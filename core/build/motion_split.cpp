#include "core/build/motion_split.h"

#include <cstddef>

namespace msbvh {
namespace {

// More, or farther about, and rays that meet both trees would pay for what the still one saves.
constexpr double kMostReferences = 0.5, kMostArea = 0.25;  // of all, of the root's

void grow(Box3f& box, std::span<const Vec3f> points) {
  for (const Vec3f& p : points) box.grow(p);
}

}  // namespace

bool moves_in_a_corner(const Primitives& primitives, std::span<const Reference> references) {
  if (primitives.swept || !primitives.slice.whole() || !primitives.grids.empty()) return false;
  if (!primitives.curves.empty() || !primitives.points.empty()) return false;
  std::size_t moving = 0;
  Box3f about, all;
  for (const auto& mesh : primitives.meshes) {
    if (!mesh->form().moving()) continue;
    moving += mesh->triangles.size();
    for (std::uint32_t c = 0; c < mesh->form().controls(); ++c)
      grow(about, {mesh->control_positions(c), mesh->vertex_count});
  }
  for (const InstanceBounds& instance : primitives.instances) {
    if (!instance.form.moving()) continue;
    ++moving;
    for (const Box3f& box : instance.controls) about.grow(box);
  }
  if (moving == 0 || double(moving) > kMostReferences * double(references.size())) return false;
  for (const Reference& reference : references) all.grow(reference.box);
  return double(half_area(about)) <= kMostArea * double(half_area(all));
}

}  // namespace msbvh
