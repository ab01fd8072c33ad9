#include "delegate/translate/light_groups.h"

namespace msbvh::translate {

void assign_light_groups(const LightGroups& groups, Scene& scene) {
  if (groups.empty()) return;
  const auto assign = [&](auto& looks) {
    for (auto& look : looks) {
      const auto found = groups.find(look.shape.name);
      if (found != groups.end()) look.light_group = found->second;
    }
  };
  assign(scene.meshes);
  assign(scene.grids);
  assign(scene.curves);
  assign(scene.points);
  for (InstanceSet& set : scene.instances) {
    const auto found = groups.find(set.name);
    if (found != groups.end()) set.light_groups.assign(instance_count(set), found->second);
  }
}

}  // namespace msbvh::translate
