#include "core/build/reference.h"

namespace msbvh {

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  if (reference.is_instance()) return primitives.instances[reference.index].form;
  if (reference.is_grid()) return primitives.grids[reference.grid_mesh()]->form();
  return primitives.meshes[reference.mesh()]->form();
}

TrackForm node_form_of(const Primitives& primitives, const Reference& reference) {
  const TrackForm form = form_of(primitives, reference);
  if (primitives.swept || !form.moving()) return {};
  return primitives.slice.whole() ? form : TrackForm{1, form.degree};
}

}  // namespace msbvh
