#include "core/build/reference.h"

namespace msbvh {

TrackForm form_of(const Primitives& primitives, const Reference& reference) {
  return reference.is_instance() ? primitives.instances[reference.index].form
                                 : primitives.meshes[reference.mesh()]->form();
}

}  // namespace msbvh
