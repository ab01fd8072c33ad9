#include "core/build/reference.h"

#include "core/base/parallel.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr std::size_t kTrianglesPerTask = 16384;

Box3f reference_box(const Primitives& primitives, const InstanceBounds& bounds) {
  if (primitives.swept) {
    Box3f box;
    for (const Box3f& b : bounds.controls) box.grow(b);
    return box;
  }
  const SegmentTime at = locate(primitives.slice.time(0.5f), bounds.form.segments);
  return track_value(bounds.controls.data(), bounds.form, at.key, at.w);
}

Box3f reference_box(const Primitives& primitives, const TriangleMesh& mesh, const Triangle& triangle) {
  Box3f box;
  if (primitives.swept) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
      for (const std::uint32_t v : triangle) box.grow(mesh.control_positions(c)[v]);
    }
    return box;
  }
  const float centre = primitives.slice.time(0.5f);
  for (const std::uint32_t v : triangle) box.grow(mesh.position(v, centre));
  return box;
}

}  // namespace

std::vector<Reference> make_references(const Primitives& primitives) {
  std::size_t count = 0;
  for (const auto& mesh : primitives.meshes) count += mesh->triangles.size();
  std::vector<Reference> references(count);
  std::size_t first = 0;
  for (std::uint32_t m = 0; m < primitives.meshes.size(); ++m) {
    const TriangleMesh& mesh = *primitives.meshes[m];
    parallel_for_ranges(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        references[first + i] = {reference_box(primitives, mesh, mesh.triangles[i]), m,
                                 static_cast<std::uint32_t>(i)};
      }
    });
    first += mesh.triangles.size();
  }
  for (std::uint32_t i = 0; i < primitives.instances.size(); ++i) {
    const InstanceBounds& bounds = primitives.instances[i];
    if (!bounds.controls.empty()) {
      references.push_back({reference_box(primitives, bounds), Reference::kInstanceOwner, i});
    }
  }
  return references;
}

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  return reference.is_instance() ? primitives.instances[reference.index].form
                                 : primitives.meshes[reference.mesh()]->form();
}

TrackForm node_form_of(const Primitives& primitives, const Reference& reference) {
  const TrackForm form = form_of(primitives, reference);
  if (primitives.swept || !form.moving()) return {};
  return primitives.slice.whole() ? form : TrackForm{1, form.degree};
}

}  // namespace msbvh
