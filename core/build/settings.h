// What a caller may choose about the build. Every field says what it costs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace msbvh {

enum class Builder : std::uint8_t {
  kMsbvh,  // object and spatial splits at the shutter's centre
  kMbvh,   // the same builder with spatial splits off: the interpolated BVH, the paper's baseline
  // For comparison, both without spatial splits:
  kSwept,     // still boxes around all that a primitive does during the shutter: few bytes, slow rays
  kTimeSplit  // a tree for each segment of the finest track: bytes and build grow with the segments
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
  bool comparison = false;  // measured where asked for
};
inline constexpr BuilderName kBuilders[] = {{Builder::kMsbvh, "msbvh"},
                                            {Builder::kMbvh, "mbvh"},
                                            {Builder::kSwept, "swept", true},
                                            {Builder::kTimeSplit, "timesplit", true}};

// What the tree of a frame takes over from that of the frame before it.
enum class Refit : std::uint8_t {
  kNever,  // nothing
  // Geometry that did not change keeps its tree; where only positions did, the topology is evaluated at the
  // new keys, and rebuilt once the tree has become expensive.
  kAuto,
  kAlways  // the same, regardless of cost
};

struct RefitName {
  Refit refit;
  const char* name;
};
inline constexpr RefitName kRefits[] = {
    {Refit::kAuto, "auto"}, {Refit::kAlways, "always"}, {Refit::kNever, "never"}};

// 8 bring a tenth more rays a second for twice the bytes (docs/design/build.md).
inline constexpr std::uint32_t kIncoherentSlices = 4;

// How a tree holds its boxes and its triangles (docs/design/compact.md has what it costs). Hits are the same.
enum class TreeLayout : std::uint8_t {
  kFull,    // planes in 32 bits; leaves have copies of their vertices where these have up to 9 keys
  kCompact  // planes in 16 bits, rounded outwards; leaves read the meshes' own tracks
};

struct TreeLayoutName {
  TreeLayout layout;
  const char* name;
};
inline constexpr TreeLayoutName kTreeLayouts[] = {{TreeLayout::kFull, "full"},
                                                  {TreeLayout::kCompact, "compact"}};
constexpr const char* name_of(TreeLayout layout) {
  return kTreeLayouts[static_cast<std::size_t>(layout)].name;
}

struct BuildSettings {
  Builder builder = Builder::kMsbvh;
  // Of all trees of a scene: instances must show trees of the same.
  TreeLayout layout = TreeLayout::kFull;
  // References that spatial splits may add, as a share of the triangles. More: fewer tests a ray on long thin
  // triangles, more bytes and a longer build. Spent only where the two conditions below hold.
  float spatial_split_budget = 1.0f;
  // Spatial splits are tried where the object split's children overlap by more than this share of the root's
  // area (Stich et al. 2009, section 4.1) ...
  float spatial_split_root_overlap = 1e-5f;
  // ... and by more than this share of their own node's. Lower: a slower build for few references more.
  float spatial_split_node_overlap = 0.3f;
  // References that re-braiding may add, as a share of the instances: those that overlap others, and whose
  // boxes are mostly empty, are referred to in parts (docs/design/rebraiding.md). More: fewer instances
  // entered a ray, a longer build (10 us a part) and a node's share of bytes a part. 0: off.
  float rebraid_budget = 8.0f;
  SahTime sah_time = SahTime::kShutter;
  // Temporal splits: trees for so many equal slices of the shutter, a power of two up to kMaxSegments; where
  // tracks are curves, at least as many as their segments. 0: kIncoherentSlices where motion is incoherent
  // and leaves are indexed anyway (17 keys and more); else 1. More: fewer nodes a ray where neighbours part,
  // and as many times the nodes, leaves (vertex tracks are shared) and build time.
  std::uint32_t time_slices = 0;
  // Nodes have no more keys than bound their children about as well. False: as many as what moves in them
  // has; a shorter build and more bytes, for hardly fewer nodes a ray (docs/features.md).
  bool fewest_keys = true;
  std::uint32_t max_leaf_triangles = 8;
  // SAH: the cost of a triangle block (8 triangles) relative to that of a node (8 boxes), and of a binary
  // split, of which a node holds 7, overlapping ones many.
  float block_cost = 2.0f;
  float split_cost = 0.5f;
  Refit refit = Refit::kAuto;  // of Accel::commit_from() and of a Renderer's second commit()
  // kAuto rebuilds where the shutter-averaged SAH cost has grown by more than this factor since the topology
  // was built. Lower: more builds; higher: slower rays (docs/design/refit.md).
  float refit_drift = 1.2f;
  // Whether a later frame may refit this tree. Costs 32 bytes a reference, 36 a binary node, and 12 a vertex
  // of meshes that spatial splits have cut.
  bool keep_topology = false;
  // Asked now and then during the build, from any thread; true stops it.
  std::function<bool()> cancelled;
};

}  // namespace msbvh
