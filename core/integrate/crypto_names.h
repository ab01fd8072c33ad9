// The names that Cryptomattes tell apart, as hashes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/film/aov_sums.h"
#include "core/shade/scene_index.h"

namespace msbvh {

// The scene must outlive it. Thread-safe.
class CryptoNames {
 public:
  CryptoNames() = default;
  explicit CryptoNames(const Scene& scene);

  // `material`: as material_index() has it.
  CryptoSample of(const HitSource& source, std::uint32_t material) const;

  // The names behind those of the hashes that are any's, each once, in the order of names. Two that share a
  // hash both stand there.
  std::vector<std::pair<std::string, std::uint32_t>> manifest(Aov aov,
                                                              std::span<const std::uint32_t> hashes) const;

 private:
  std::string instance_name(std::size_t set, std::size_t instance) const;
  std::uint32_t object_hash(const HitSource& source) const;

  const Scene* scene_ = nullptr;
  std::array<std::vector<std::uint32_t>, 4> objects_;  // by GeometryKind, then its place in the scene
  std::vector<std::uint32_t> materials_;
  std::vector<std::vector<std::uint32_t>> instances_;  // by set; 0: what is no instance
};

}  // namespace msbvh
