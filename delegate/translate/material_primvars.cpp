#include "delegate/translate/material_primvars.h"

#include <algorithm>
#include <set>
#include <utility>

namespace msbvh::translate {
namespace {

std::set<PrimvarName> names_read(const MeshInput& input, const MaterialTable& materials) {
  std::set<std::uint32_t> numbers{input.material};
  for (const int material : input.face_materials) {
    if (material >= 0) numbers.insert(std::uint32_t(material));
  }
  std::set<PrimvarName> names(materials.kept().begin(), materials.kept().end());
  for (const std::uint32_t number : numbers) {
    const std::span<const PrimvarName> read = materials.reads(number);
    names.insert(read.begin(), read.end());
  }
  return names;
}

}  // namespace

std::vector<msbvh::SurfacePrimvar> material_primvars(
    const MeshInput& input, const MaterialTable& materials,
    const std::function<Primvar<Vec3f>(const NamedPrimvar&)>& flattened) {
  std::vector<msbvh::SurfacePrimvar> found;
  if (input.named_primvars.empty()) return found;
  const std::set<PrimvarName> read = names_read(input, materials);
  for (const NamedPrimvar& named : input.named_primvars) {
    const PrimvarName name = materials.find(named.name);
    if (name == kNoPrimvar || !read.contains(name)) continue;
    NamedPrimvar finer = named;
    finer.primvar.tolerance = kMaterialTolerance;
    Primvar<Vec3f> values = flattened(finer);
    if (values.authored()) found.push_back({name, std::move(values)});
  }
  std::ranges::sort(found, {}, &msbvh::SurfacePrimvar::name);
  return found;
}

}  // namespace msbvh::translate
