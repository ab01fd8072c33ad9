// What a caller may choose about the build. Every field says what it costs.
#pragma once

#include <cstdint>
#include <functional>

namespace msbvh {

enum class Builder : std::uint8_t {
  kMsbvh,  // object and spatial splits at the shutter's centre
  kMbvh    // the same builder with spatial splits off: the interpolated BVH, the paper's baseline
};

// When the SAH looks at boxes.
enum class SahTime : std::uint8_t {
  kCentre,  // at the shutter's centre, as the paper has it
  kShutter  // averaged over the shutter, with splits by velocity too, where motion is incoherent; else at the
            // centre. Costs nothing to a still scene, a sample here and there to a coherent one.
};

// All of them, by the names that options and reports use.
struct BuilderName {
  Builder builder;
  const char* name;
};
inline constexpr BuilderName kBuilders[] = {{Builder::kMsbvh, "msbvh"}, {Builder::kMbvh, "mbvh"}};

struct BuildSettings {
  Builder builder = Builder::kMsbvh;
  // References that spatial splits may add, as a share of the triangles. More: fewer tests a ray on long thin
  // triangles, more bytes and a longer build. Spent only where the two conditions below hold.
  float spatial_split_budget = 1.0f;
  // Spatial splits are tried where the object split's children overlap by more than this share of the root's
  // area (Stich et al. 2009, section 4.1) ...
  float spatial_split_root_overlap = 1e-5f;
  // ... and by more than this share of their own node's. Lower: a slower build for few references more.
  float spatial_split_node_overlap = 0.3f;
  SahTime sah_time = SahTime::kShutter;
  std::uint32_t max_leaf_triangles = 8;
  // SAH: the cost of a triangle block (8 triangles) relative to that of a node (8 boxes), and of a binary
  // split, of which a node holds 7, overlapping ones many.
  float block_cost = 2.0f;
  float split_cost = 0.5f;
  // Asked now and then during the build, from any thread; true stops it.
  std::function<bool()> cancelled;
};

}  // namespace msbvh
