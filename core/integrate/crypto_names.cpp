#include "core/integrate/crypto_names.h"

#include <algorithm>
#include <set>

#include "core/film/name_hash.h"

namespace msbvh {
namespace {

constexpr const char* kNoMaterial = "none";

template <typename Shapes>
void add_hashes(const Shapes& shapes, std::vector<std::uint32_t>& hashes) {
  for (const auto& each : shapes) hashes.push_back(name_hash(each.shape.name));
}

// In its instancer; below 0: it is none.
std::int32_t number_of(const InstanceSet& set, std::size_t instance) {
  return set.ids.empty() ? static_cast<std::int32_t>(instance) : set.ids[instance];
}

}  // namespace

CryptoNames::CryptoNames(const Scene& scene) : scene_(&scene) {
  add_hashes(scene.meshes, objects_[std::size_t(GeometryKind::kTriangleMesh)]);
  add_hashes(scene.grids, objects_[std::size_t(GeometryKind::kGridMesh)]);
  add_hashes(scene.curves, objects_[std::size_t(GeometryKind::kCurves)]);
  add_hashes(scene.points, objects_[std::size_t(GeometryKind::kPoints)]);
  for (const Material& material : scene.materials) materials_.push_back(name_hash(material.name));
  for (std::size_t s = 0; s < scene.instances.size(); ++s) {
    const InstanceSet& set = scene.instances[s];
    std::vector<std::uint32_t>& hashes = instances_.emplace_back(instance_count(set), 0u);
    for (std::size_t i = 0; i < hashes.size(); ++i) {
      if (number_of(set, i) >= 0) hashes[i] = name_hash(instance_name(s, i));
    }
  }
}

std::string CryptoNames::instance_name(std::size_t set, std::size_t instance) const {
  const InstanceSet& found = scene_->instances[set];
  return found.name + "[" + std::to_string(number_of(found, instance)) + "]";
}

std::uint32_t CryptoNames::object_hash(const HitSource& source) const {
  const auto at = [&](GeometryKind kind, std::size_t i) { return objects_[std::size_t(kind)][i]; };
  if (source.mesh) return at(GeometryKind::kTriangleMesh, std::size_t(source.mesh - scene_->meshes.data()));
  if (source.grids) return at(GeometryKind::kGridMesh, std::size_t(source.grids - scene_->grids.data()));
  if (source.curves) return at(GeometryKind::kCurves, std::size_t(source.curves - scene_->curves.data()));
  return at(GeometryKind::kPoints, std::size_t(source.points - scene_->points.data()));
}

CryptoSample CryptoNames::of(const HitSource& source, std::uint32_t material) const {
  static const std::uint32_t none = name_hash(kNoMaterial);
  const std::uint32_t object = object_hash(source);
  std::uint32_t instance = 0;
  if (source.instances)
    instance = instances_[std::size_t(source.instances - scene_->instances.data())][source.instance];
  return {object, material < materials_.size() ? materials_[material] : none, instance ? instance : object};
}

std::vector<std::pair<std::string, std::uint32_t>> CryptoNames::manifest(
    Aov aov, std::span<const std::uint32_t> hashes) const {
  const std::set<std::uint32_t> wanted(hashes.begin(), hashes.end());
  std::set<std::pair<std::string, std::uint32_t>> found;
  const auto add = [&](const std::string& name, std::uint32_t hash) {
    if (wanted.contains(hash)) found.emplace(name, hash);
  };
  const auto add_named = [&](const auto& shapes, GeometryKind kind) {
    for (std::size_t i = 0; i < shapes.size(); ++i) add(shapes[i].shape.name, objects_[std::size_t(kind)][i]);
  };
  if (aov == Aov::kCryptoMaterial) {
    for (std::size_t i = 0; i < materials_.size(); ++i) add(scene_->materials[i].name, materials_[i]);
    add(kNoMaterial, name_hash(kNoMaterial));
    return {found.begin(), found.end()};
  }
  add_named(scene_->meshes, GeometryKind::kTriangleMesh);
  add_named(scene_->grids, GeometryKind::kGridMesh);
  add_named(scene_->curves, GeometryKind::kCurves);
  add_named(scene_->points, GeometryKind::kPoints);
  for (std::size_t s = 0; aov == Aov::kCryptoInstance && s < instances_.size(); ++s) {
    for (std::size_t i = 0; i < instances_[s].size(); ++i) {
      if (wanted.contains(instances_[s][i])) add(instance_name(s, i), instances_[s][i]);
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace msbvh
