// The state of many paths that go forward together, an array a quantity.
//
// A stage (one a file) takes the whole batch a step further, so that all of its rays are traced at once and
// all of its code and tables are in cache. A. Afra, C. Benthin, I. Wald, J. Munkberg, "Local Shading
// Coherence Extraction for SIMD-Efficient Path Tracing on CPUs", HPG 2016; M. Lee, B. Green, F. Xie, E.
// Tabellion, "Vectorized Production Path Tracing", HPG 2017.
//
// Paths are numbered in the order in which they were generated: by time stratum, then by squares of pixels.
// That is the order of every queue too: rays that are traced together share a segment of the motion and look
// the same way. No path's numbers depend on another's, so a batch's size and order do not change the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/film/aov_sums.h"
#include "core/film/film_sample.h"
#include "core/integrate/draw_pairs.h"
#include "core/integrate/material_reads.h"
#include "core/integrate/sampler.h"
#include "core/integrate/stage_mark.h"
#include "core/scene/light.h"
#include "core/shade/bsdf/bsdf.h"
#include "core/shade/bsdf/special_lobe.h"
#include "core/shade/material/cover.h"
#include "core/shade/material/texture_place.h"
#include "core/shade/surface_hit.h"
#include "core/trace/ray.h"
#include "core/trace/tracer.h"

namespace msbvh {

using PathIndex = std::uint32_t;

inline constexpr std::size_t kMaxBatchPaths = 4096;

// Shadow rays on their way, and what each brings its path if nothing is in its way.
class ShadowQueue {
 public:
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  void resize(std::size_t size) { size_ = size; }  // to no more than there are
  void reserve(std::size_t most);                  // before add()

  void add(const Ray& ray, PathIndex path, const Vec3f& contribution) {
    set(size_++, ray, path, contribution);
  }
  void set(std::size_t i, const Ray& ray, PathIndex path, const Vec3f& contribution) {
    rays_[i] = ray;
    path_[i] = path;
    contribution_[i] = contribution;
  }

  // Of lights with shadow settings (controlled_shadow.h), which take memory for no others.
  struct Dimmed {
    const Light* light;
    float left = 1.0f;      // of the ray, behind what it has passed
    float shadowed = 0.0f;  // of the light
  };
  void add_dimmed(const Ray& ray, PathIndex path, const Vec3f& contribution, const Dimmed& dimmed) {
    if (dimmed_.size() < rays_.size()) dimmed_.resize(rays_.size());
    set_dimmed(size_++, ray, path, contribution, dimmed);
  }
  void set_dimmed(std::size_t i, const Ray& ray, PathIndex path, const Vec3f& contribution,
                  const Dimmed& dimmed) {
    set(i, ray, path, contribution);
    dimmed_[i] = dimmed;
  }
  const Dimmed& dimmed(std::size_t i) const { return dimmed_[i]; }

  std::span<const Ray> rays() const { return {rays_.data(), size_}; }
  PathIndex path(std::size_t i) const { return path_[i]; }
  const Vec3f& contribution(std::size_t i) const { return contribution_[i]; }

 private:
  std::size_t size_ = 0;
  std::vector<Ray> rays_;
  std::vector<PathIndex> path_;
  std::vector<Vec3f> contribution_;
  std::vector<Dimmed> dimmed_;
};

struct PathBatch {
  // By path.
  std::vector<Sampler> sampler;
  std::vector<std::uint32_t> slot;  // [sample of the batch][pixel of the tile]
  std::vector<Vec3f> throughput;
  std::vector<Vec3f> radiance;
  std::vector<float> alpha;
  // Where AOVs ask for them.
  std::vector<AovSample> aovs;
  std::vector<CostSum> costs;
  std::vector<CryptoSample> crypto;
  std::vector<LightParts<float>> light;
  // Of radiance, what specular lobes of the first surface reflected (light_parts.h). Empty where nobody asks.
  std::vector<Vec3f> specular;
  // That share of what comes by the first surface's scattered ray, and by the ray to a light at hand.
  std::vector<Vec3f> scattered_share, light_share;
  std::vector<Vec3f> credited;                 // of radiance, what `specular` has been given its share of
  std::vector<Vec3f> sorted, sorted_specular;  // what of both `light` has
  std::vector<std::uint16_t> shutter_slice;    // where the shutter is kept in slices
  std::vector<Vec3f> direct;                   // radiance without indirect light, where that is clamped

  // Paths under way, and by their places in this queue: their ray, its hit, and what was hit.
  std::uint32_t depth = 0;  // vertices behind them
  std::vector<PathIndex> active;
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<SurfaceHit> surfaces;
  // Places in the queue of those that are on a surface, in the order of the queue.
  std::vector<std::uint32_t> shaded;
  std::vector<PathIndex> shaded_paths;  // theirs
  // By places in the queue: the ray that goes on from the surface, and the density of its direction per
  // steradian; 0 where none does.
  std::vector<Ray> scattered;
  std::vector<float> scatter_pdf;
  // Likewise, where some surface reflects otherwise than diffusely: how it reflects, and what the scattered
  // ray carries. Else a surface's albedo is in its path's throughput already.
  std::vector<Bsdf> bsdfs;
  std::vector<Vec3f> scatter_weight;
  // Likewise, where something is not opaque and something reflects: how the surface was met (covers.h).
  std::vector<Cover> covers;
  // Likewise, where something is of glass or a fibre: what takes the place of its Bsdf.
  std::vector<SpecialLobe> special;
  std::vector<std::uint8_t> within;  // by path, where light is bent: 1 inside of glass
  // By path, where something is textured.
  std::vector<RayCone> cones;
  std::vector<float> widths;  // of the cones where they met a surface

  ShadowQueue shadows;
  TraceModes traced;
  StageMark mark;

  // Of stages, between their own steps.
  std::vector<std::uint64_t> by_material;  // places in the queue, their materials in the upper half
  std::vector<PathIndex> path_at_slot;
  std::vector<float> times;  // by slot
  DrawnPairs drawn, lobes;   // by the order of `shaded`
  MaterialReads reads;
  std::vector<Cover> found_covers;  // by the order of the rays at hand
  std::vector<std::uint32_t> retraced;
  std::vector<Ray> retraced_rays;
  std::vector<Hit> retraced_hits;
  std::vector<float> retraced_widths;  // of their cones, where something is textured
  std::unique_ptr<bool[]> occluded = std::make_unique<bool[]>(kMaxBatchPaths);

  // Room for some paths, none of them under way. Memory is kept from batch to batch.
  void reset(std::size_t paths);
};

// What the arrays above take, AOVs and looks apart. Four rays: at hand, scattered, shadow and retraced; two
// hits.
inline constexpr std::size_t kBytesAPath = sizeof(Sampler) + 4 * sizeof(Ray) + 2 * sizeof(Hit) +
                                           sizeof(SurfaceHit) + 3 * sizeof(Vec3f) + 8 * sizeof(PathIndex) +
                                           sizeof(std::uint64_t) + 5 * sizeof(float) + sizeof(bool);

}  // namespace msbvh
