// Arbitrary output variables: what else a pixel tells beside its colour, by Hydra's names.
//
// Vectors and colours are means over all samples of the pixel, as colour is: premultiplied, 0 where nothing
// was seen. Depths and ids cannot be averaged: they are those of the nearest sample, the first of equals.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "core/base/vec.h"

namespace msbvh {

enum class Aov : std::uint8_t {
  kDepth,        // 0 at the near clipping plane, 1 at the far one and where nothing is, as OpenGL has it
  kCameraDepth,  // scene units along the camera's -z; infinite where nothing is
  kPrimId,       // of the mesh, -1 where nothing is
  kInstanceId,   // in its instancer, -1 for what is none
  kElementId,    // the face, in USD's topology; -1 where nothing is
  kNeye,         // unit normal in the camera's space
  kNormal,       // unit shading normal in the world, on the side that is seen
  kAlbedo        // the share of light that the surface reflects
};
inline constexpr std::size_t kAovCount = 8;

struct AovForm {
  const char* name;
  std::uint32_t channels;
  bool is_id;  // an integer
};

constexpr AovForm form_of(Aov aov) {
  constexpr std::array<AovForm, kAovCount> kForms{{{"depth", 1, false},
                                                   {"cameraDepth", 1, false},
                                                   {"primId", 1, true},
                                                   {"instanceId", 1, true},
                                                   {"elementId", 1, true},
                                                   {"Neye", 3, false},
                                                   {"normal", 3, false},
                                                   {"albedo", 3, false}}};
  return kForms[static_cast<std::size_t>(aov)];
}

constexpr std::optional<Aov> aov_named(std::string_view name) {
  for (std::size_t i = 0; i < kAovCount; ++i) {
    if (name == form_of(Aov(i)).name) return Aov(i);
  }
  return std::nullopt;
}

// What one sample saw. As constructed: nothing.
struct AovSample {
  float camera_depth = std::numeric_limits<float>::infinity();
  float depth = 1.0f;
  std::int32_t prim = -1, instance = -1, element = -1;
  Vec3f eye_normal, normal, albedo;
};

// Over many samples, in any order of blocks: the nearest is the nearest whoever compares first.
struct AovSum {
  float camera_depth = std::numeric_limits<float>::infinity();
  float depth = 1.0f;
  std::uint32_t number = 0xffffffffu;  // of the nearest sample
  std::int32_t prim = -1, instance = -1, element = -1;
  Vec3d eye_normal, normal, albedo;

  void add(const AovSample& sample, std::uint32_t sample_number) {
    AovSum one;
    one.camera_depth = sample.camera_depth;
    one.depth = sample.depth;
    one.number = sample_number;
    one.prim = sample.prim;
    one.instance = sample.instance;
    one.element = sample.element;
    one.eye_normal = Vec3d(sample.eye_normal);
    one.normal = Vec3d(sample.normal);
    one.albedo = Vec3d(sample.albedo);
    *this += one;
  }
  AovSum& operator+=(const AovSum& b) {
    if (b.camera_depth < camera_depth || (b.camera_depth == camera_depth && b.number < number)) {
      camera_depth = b.camera_depth;
      depth = b.depth;
      number = b.number;
      prim = b.prim;
      instance = b.instance;
      element = b.element;
    }
    eye_normal += b.eye_normal;
    normal += b.normal;
    albedo += b.albedo;
    return *this;
  }

  // form_of(aov).channels numbers, of `count` samples. Not for ids.
  void resolve(Aov aov, std::uint32_t count, float* out) const;
  std::int32_t id(Aov aov) const;
};

}  // namespace msbvh
