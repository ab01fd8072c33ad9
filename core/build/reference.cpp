#include "core/build/reference.h"

#include "core/geometry/curve_piece.h"

namespace msbvh {

Box3f round_box(const Primitives& primitives, const Reference& reference, std::uint32_t control) {
  const std::uint32_t set = reference.round_set();
  if (reference.is_curve())
    return piece_box(*primitives.curves[set], CurvePiece::of(reference.index), control);
  return point_box(*primitives.points[set], reference.index, control);
}

Box3f round_box_at(const Primitives& primitives, const Reference& reference, float u) {
  const std::uint32_t set = reference.round_set();
  if (reference.is_curve()) return piece_box_at(*primitives.curves[set], CurvePiece::of(reference.index), u);
  return point_box_at(*primitives.points[set], reference.index, u);
}

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  if (reference.is_instance()) return primitives.instances[reference.index].form;
  if (reference.is_grid()) return primitives.grids[reference.grid_mesh()]->form();
  if (reference.is_curve()) return primitives.curves[reference.round_set()]->form();
  if (reference.is_point()) return primitives.points[reference.round_set()]->form();
  return primitives.meshes[reference.mesh()]->form();
}

TrackForm node_form_of(const Primitives& primitives, const Reference& reference) {
  const TrackForm form = form_of(primitives, reference);
  if (primitives.swept || !form.moving()) return {};
  return primitives.slice.whole() ? form : TrackForm{1, form.degree};
}

}  // namespace msbvh
