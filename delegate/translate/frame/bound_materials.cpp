#include "delegate/translate/frame/bound_materials.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/texture/plain_color.h"
#include "delegate/translate/look/constant_textures.h"
#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"

namespace msbvh::translate {

BoundMaterials::BoundMaterials(const std::vector<FrameMaterial>& materials, const TextureSource& textures,
                               Translator& translator)
    : textures_(textures), translator_(translator) {
  for (const FrameMaterial& material : materials) networks_.emplace(material.path, &material.network);
}

const BoundMaterials::Bound& BoundMaterials::bound(const std::string& path) {
  const auto known = bound_.find(path);
  if (known != bound_.end()) return known->second;
  const auto network = networks_.find(path);
  const Bound found = network == networks_.end() ? Bound{} : hand_down(*network->second);
  return bound_.emplace(path, found).first->second;
}

BoundMaterials::Bound BoundMaterials::hand_down(const ShaderNetwork& network) {
  std::optional<SurfaceLook> surface = preview_surface(network, textures_, diagnostics_);
  const std::optional<Displacement> displaced = displacement_of(network, textures_, diagnostics_);
  if (!surface) {
    if (displaced) {
      diagnostics_.push_back({Severity::kWarning, network.path, "outputs:displacement",
                              "not drawn, since the material's surface is not"});
    }
    return {};
  }
  fold_constant_textures(*surface, kLinearRec709);
  Bound found;
  for (const NeededPrimvar& each : surface->primvars) found.needed_primvars.push_back(each.name);
  if (displaced && !displaced->needed_primvar().empty())
    found.needed_primvars.push_back(displaced->needed_primvar());
  found.number = translator_.add_material(std::move(*surface), displaced);
  return found;
}

void BoundMaterials::bind(const FrameShape& shape, MeshInput& mesh, std::vector<int>& face_materials) {
  std::set<std::string> needed;
  const auto number_of = [&](const std::string& path) {
    const Bound& found = path.empty() ? Bound{} : bound(path);
    needed.insert(found.needed_primvars.begin(), found.needed_primvars.end());
    return found.number ? int(*found.number) : -1;
  };
  const int own = number_of(shape.material);
  mesh.material = own < 0 ? kNone : std::uint32_t(own);
  if (!shape.subsets.empty()) {
    std::vector<FaceSubset> faces;
    std::vector<int> materials;
    for (const BoundSubset& subset : shape.subsets) {
      faces.push_back(subset.faces);
      materials.push_back(number_of(subset.material));
    }
    const std::vector<int> owners = face_owners(faces, mesh.face_vertex_counts.size(), diagnostics_);
    face_materials = translate::face_materials(owners, materials, own);
    mesh.face_materials = face_materials;
  }
  if (mesh.round.kind == RoundInput::Kind::kCurves) needed.emplace(kFibrePrimvar);
  std::erase_if(mesh.named_primvars, [&](const NamedPrimvar& each) { return !needed.contains(each.name); });
}

}  // namespace msbvh::translate
