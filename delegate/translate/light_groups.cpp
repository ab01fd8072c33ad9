#include "delegate/translate/light_groups.h"

namespace msbvh::translate {

namespace {

std::uint32_t group_of(const std::vector<std::uint32_t>& groups, std::size_t id) {
  if (groups.size() == 1) return groups.front();
  return id < groups.size() ? groups[id] : 0;
}

}  // namespace

void assign_light_groups(const LightGroups& groups, Scene& scene) {
  if (groups.empty()) return;
  const auto assign = [&](auto& looks) {
    for (auto& look : looks) {
      const auto found = groups.find(look.shape.name);
      if (found != groups.end()) look.light_group = group_of(found->second, 0);
    }
  };
  assign(scene.meshes);
  assign(scene.grids);
  assign(scene.curves);
  assign(scene.points);
  for (InstanceSet& set : scene.instances) {
    const auto found = groups.find(set.name);
    if (found == groups.end()) continue;
    for (std::size_t i = 0; i < instance_count(set); ++i)
      set.light_groups.push_back(group_of(found->second, set.ids.empty() ? i : std::size_t(set.ids[i])));
  }
}

}  // namespace msbvh::translate
