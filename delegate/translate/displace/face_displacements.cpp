#include "delegate/translate/displace/face_displacements.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

bool is_distance(const Vec3f& value) { return std::abs(double(value.x)) <= kMaxDistance; }
bool is_coordinate(const Vec3f& value) { return std::isfinite(value.x) && std::isfinite(value.y); }

// `visit(values)` of the frame and at all samples.
template <typename Visit>
void for_values(const PrimvarInput<Vec3f>& primvar, const Visit& visit) {
  visit(primvar.values);
  for (const PrimvarSample<Vec3f>& sample : primvar.samples) visit(sample.values);
}

}  // namespace

FaceDisplacements::FaceDisplacements(const MeshInput& input, Displacements by_material, PrimLog& log)
    : input_(input), by_material_(by_material) {
  if (!input.displaced) return;
  if (std::ranges::none_of(by_material, [](const auto& found) { return found.has_value(); })) return;
  const auto use = [&](std::int64_t material) {
    const Displacement* found = of_material(material);
    if (found && std::ranges::find(used_, found) == used_.end()) used_.push_back(found);
  };
  if (input.face_materials.size() == input.face_vertex_counts.size()) {
    std::vector<int> materials(input.face_materials.begin(), input.face_materials.end());
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    for (const int material : materials) use(material);
  } else {
    use(input.material);
  }
  if (!check_primvars(log)) used_.clear();
}

const Displacement* FaceDisplacements::of_material(std::int64_t material) const {
  if (material < 0 || material >= std::int64_t(by_material_.size())) return nullptr;
  const std::optional<Displacement>& found = by_material_[std::size_t(material)];
  return found ? &*found : nullptr;
}

const Displacement* FaceDisplacements::of_face(std::uint32_t face) const {
  if (!any()) return nullptr;
  const bool own = input_.face_materials.size() == input_.face_vertex_counts.size();
  return of_material(own ? input_.face_materials[face] : std::int64_t(input_.material));
}

const NamedPrimvar* FaceDisplacements::primvar(const std::string& name) const {
  const auto found = std::ranges::find(input_.named_primvars, name, &NamedPrimvar::name);
  return found == input_.named_primvars.end() || found->primvar.values.empty() ? nullptr : &*found;
}

bool FaceDisplacements::check_primvars(PrimLog& log) const {
  for (const Displacement* displacement : used_) {
    const NamedPrimvar* named = primvar(displacement->needed_primvar());
    if (!named) continue;
    const bool distances = !displacement->texture;
    bool good = true;
    for_values(named->primvar, [&](std::span<const Vec3f> values) {
      const auto bad = std::ranges::find_if_not(values, distances ? is_distance : is_coordinate);
      if (!good || bad == values.end()) return;
      good = false;
      const auto found = distances ? message(bad->x) : message("(", bad->x, ", ", bad->y, ")");
      log.warn("primvars:" + named->name,
               message("value ", bad - values.begin(), " is ", found, "; expected ",
                       distances ? "finite numbers of at most 2^40 in size" : "finite texture coordinates",
                       "; drawn without displacement"));
    });
    if (!good) return false;
  }
  return true;
}

bool FaceDisplacements::is_still() const {
  return std::ranges::none_of(used_, [&](const Displacement* displacement) {
    const NamedPrimvar* named = displacement->texture ? nullptr : primvar(displacement->primvar);
    return named && !named->primvar.samples.empty();
  });
}

double FaceDisplacements::reach() const {
  double reach = 0.0;
  for (const Displacement* displacement : used_) {
    const Displacement& d = *displacement;
    if (d.texture) {
      for (const double value : {d.texture->least(), d.texture->largest()})
        reach = std::max(reach, std::abs(value * d.scale + d.bias));
      continue;
    }
    reach = std::max(reach, std::abs(d.constant));
    const NamedPrimvar* named = primvar(d.primvar);
    if (!named) continue;
    for_values(named->primvar, [&](std::span<const Vec3f> values) {
      for (const Vec3f& value : values) reach = std::max(reach, double(std::abs(value.x)));
    });
  }
  return reach;
}

}  // namespace msbvh::translate
