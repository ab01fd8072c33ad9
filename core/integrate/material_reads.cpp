#include "core/integrate/material_reads.h"

#include <algorithm>

namespace msbvh {

void MaterialReads::read(const TextureCache& textures, const Material& material,
                         std::span<const MaterialHit> hits_read, std::optional<std::uint32_t> only) {
  reads_ = material.texture_reads.size();
  texels_.assign(hits_read.size() * reads_, {});
  place_of_read_.assign(reads_, 0);
  place_names_.clear();
  for (std::uint32_t which = 0; which < reads_; ++which) {
    if (!only || *only == which) read_one(textures, material, hits_read, which);
  }
}

void MaterialReads::read_one(const TextureCache& textures, const Material& material,
                             std::span<const MaterialHit> hits_read, std::uint32_t which) {
  const TextureRead& read = material.texture_reads[which];
  const std::size_t places = place_of_read_[which] = places_of(read.coordinates, hits_read);
  queries_.resize(hits_read.size());
  found_.resize(hits_read.size());
  for (std::size_t i = 0; i < hits_read.size(); ++i) {
    const MaterialHit& hit = hits_read[i];
    queries_[i] =
        texture_query(read, places_[places][i], hit.geometric_normal, normalize(hit.ray->dir), hit.width);
  }
  textures.read(read.texture, queries_, found_);
  for (std::size_t i = 0; i < hits_read.size(); ++i) texels_[i * reads_ + which] = found_[i];
}

std::size_t MaterialReads::places_of(PrimvarName name, std::span<const MaterialHit> hits_read) {
  const std::size_t known = std::size_t(std::ranges::find(place_names_, name) - place_names_.begin());
  if (known < place_names_.size()) return known;
  place_names_.push_back(name);
  if (places_.size() < place_names_.size()) places_.emplace_back();
  std::vector<std::optional<TexturePlace>>& places = places_[known];
  places.clear();
  for (const MaterialHit& hit : hits_read) {
    places.push_back(name == kNoPrimvar ? std::nullopt : texture_place(hit.source, *hit.hit, *hit.ray, name));
  }
  return known;
}

}  // namespace msbvh
