#include "core/build/reference.h"

namespace msbvh {

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  if (reference.is_instance()) return primitives.instances[reference.index].form;
  if (reference.is_grid()) return primitives.grids[reference.grid_mesh()]->form();
  return primitives.meshes[reference.mesh()]->form();
}

}  // namespace msbvh
