// What paths read; the same for a whole frame.
#pragma once

#include <cstdint>

#include "core/film/aov.h"
#include "core/film/film_settings.h"
#include "core/integrate/crypto_names.h"
#include "core/integrate/sampler.h"
#include "core/integrate/stages.h"
#include "core/shade/clearance.h"
#include "core/shade/light/light_sampler.h"
#include "core/shade/scene_index.h"
#include "core/texture/texture_cache.h"
#include "core/trace/tracer.h"

namespace msbvh {

// Thread-safe.
struct Frame {
  SceneIndex index;
  LightSampler lights;
  const Bvh& world;  // that the tracer traces
  Tracer tracer;
  std::uint32_t width, height;  // of the image, pixels
  std::uint32_t seed;
  std::uint32_t max_bounces;  // 0: direct light only, as it must be without indirect light
  bool show_domes;            // camera rays that meet nothing see the dome
  Sampling sampling;
  const TextureCache* textures;  // null where nothing is textured
  Stages stages;
  // Read where samples lie anywhere but evenly in pixels and shutter: FilmSettings::shapes_samples().
  FilterSampler filter{};
  ShutterSampler shutter{};
  AovSet aovs{};  // that are asked for
  FrameTime frame_time{};
  Vec3d origin{};                    // of the frame's world, in the stage's
  CryptoNames crypto_names{};        // where they are asked for
  std::uint32_t shutter_slices = 0;  // 0: the shutter is not kept in slices
  float texture_rate = 1.0f;         // of the widths that textures are filtered over
  float clamp_indirect = 0.0f;  // most indirect light of a path (clamp_indirect.h); 0: as much as there is
  bool refraction = false;      // something transparent bends light
  bool fibres = false;          // some curves scatter light as hair does
  float exposure = 1.0f;        // FilmSettings::exposure

  const Scene& scene() const { return index.scene(); }
  Surroundings surroundings() const { return {index, world}; }
};

}  // namespace msbvh
