// Arbitrary output variables: what else a pixel tells beside its colour. By Hydra's names where it has one,
// Nuke's for motion.
//
// Each is of one of these kinds:
// - of the nearest sample, the first of equals: depths, ids, places and motion, which cannot be averaged;
// - a mean over all samples of the pixel, as colour is: premultiplied, 0 where nothing was seen;
// - a total, an error or the coverage of all samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace msbvh {

enum class Aov : std::uint8_t {
  kDepth,        // 0 at the near clipping plane, 1 at the far one and where nothing is, as OpenGL has it
  kCameraDepth,  // scene units along the camera's -z; infinite where nothing is
  kPrimId,       // of the mesh, -1 where nothing is
  kInstanceId,   // in its instancer, -1 for what is none
  kElementId,    // the face, in USD's topology; -1 where nothing is
  kNeye,         // unit normal in the camera's space
  kNormal,       // unit shading normal in the world, on the side that is seen
  kAlbedo,       // the share of light that the surface reflects
  // Of the nearest sample; 0 where nothing is.
  kPeye,    // its place in the camera's space, at the sample's time
  kPworld,  // its place in the world, at the sample's time
  kSt,      // the primvar st there; 0 where there is none
  // How fast the point of the surface moves over the picture at the frame, pixels a frame, x to the right and
  // y up: to where it is seen a frame later, and where it was seen a frame before, at the speed that it has
  // right after the frame and right before it. So `backward` is -`forward` where nothing turns at the frame.
  kForward,
  kBackward,
  // The point's way over the picture during the shutter as a cubic Bezier curve: x and y of four controls,
  // pixels from where it is at the frame. Ends and speeds there are exact; between them, too, where the way
  // is a cubic, which it is of a track of one segment before an orthographic camera that stands still.
  kMotionCurve,
  // Of all samples.
  kSampleCount,
  kNoise,  // standard error of the pixel's luminance: of independent samples; well-spread ones have less
  // What samples' camera rays meet in the tree, in the mean.
  kNodeVisits,
  kPrimitiveTests,  // triangles, spans of curves and points
  kSeconds,         // that a thread spent on the pixel: the one that differs from run to run
  // Colour by the way of its light. What a surface is given by lights, straight: direct; what by other
  // surfaces: indirect. Of either, what the first surface's diffuse and specular lobes reflect. Emission:
  // what comes to the camera from surfaces that glow and from domes behind the scene. They sum up to colour.
  kDirectDiffuse,
  kDirectSpecular,
  kIndirectDiffuse,
  kIndirectSpecular,
  kEmission,
  // Cryptomatte (specification 1.2.0): the hashes of names, and how many of the pixel's samples saw them.
  kCryptoObject,    // the prim's path
  kCryptoMaterial,  // the material's path; "none" without one
  kCryptoInstance   // the instancer's path and the instance's number in it; the prim's path for what is none
};
inline constexpr std::size_t kAovCount = 27;
// The last of those that read nothing beside the surface that a camera ray meets first.
inline constexpr Aov kLastSurfaceAov = Aov::kAlbedo;

// Names that a pixel tells of, those that cover most of it; two in each layer of a file.
inline constexpr std::uint32_t kCryptoRanks = 6;

// How pictures of some of a pixel's samples make one of all.
enum class AovMerge : std::uint8_t {
  kNearest,
  kMean,
  kTotal,
  kError,
  kCoverage  // pairs of a name and its share, which are cut off: pictures of some samples make none of all
};

struct AovForm {
  const char* name;
  const char* channels;  // a letter each; empty: one without a name
  AovMerge merge;
  bool is_id;             // an integer
  std::uint32_t numbers;  // a pixel
};

constexpr AovForm form_of(Aov aov) {
  using enum AovMerge;
  constexpr std::array<AovForm, kAovCount> kForms{{{"depth", "", kNearest, false, 1},
                                                   {"cameraDepth", "", kNearest, false, 1},
                                                   {"primId", "", kNearest, true, 1},
                                                   {"instanceId", "", kNearest, true, 1},
                                                   {"elementId", "", kNearest, true, 1},
                                                   {"Neye", "XYZ", kMean, false, 3},
                                                   {"normal", "XYZ", kMean, false, 3},
                                                   {"albedo", "RGB", kMean, false, 3},
                                                   {"Peye", "XYZ", kNearest, false, 3},
                                                   {"Pworld", "XYZ", kNearest, false, 3},
                                                   {"st", "st", kNearest, false, 2},
                                                   {"forward", "uv", kNearest, false, 2},
                                                   {"backward", "uv", kNearest, false, 2},
                                                   {"motionCurve", "uvuvuvuv", kNearest, false, 8},
                                                   {"sampleCount", "", kTotal, false, 1},
                                                   {"noise", "", kError, false, 1},
                                                   {"nodeVisits", "", kMean, false, 1},
                                                   {"primitiveTests", "", kMean, false, 1},
                                                   {"seconds", "", kTotal, false, 1},
                                                   {"directDiffuse", "RGB", kMean, false, 3},
                                                   {"directSpecular", "RGB", kMean, false, 3},
                                                   {"indirectDiffuse", "RGB", kMean, false, 3},
                                                   {"indirectSpecular", "RGB", kMean, false, 3},
                                                   {"emission", "RGB", kMean, false, 3},
                                                   {"cryptoObject", "RGBA", kCoverage, false, 12},
                                                   {"cryptoMaterial", "RGBA", kCoverage, false, 12},
                                                   {"cryptoInstance", "RGBA", kCoverage, false, 12}}};
  return kForms[static_cast<std::size_t>(aov)];
}

constexpr std::optional<Aov> aov_named(std::string_view name) {
  for (std::size_t i = 0; i < kAovCount; ++i) {
    if (name == form_of(Aov(i)).name) return Aov(i);
  }
  return std::nullopt;
}

// Of a layer's channels: "normal.X", "forward.u", "motionCurve.u0", "cryptoObject00.R"; the layer's own where
// there is one alone.
std::vector<std::string> channel_names(Aov aov, const std::string& layer);

class AovSet {
 public:
  constexpr bool empty() const { return bits_ == 0; }
  constexpr bool has(Aov aov) const { return (bits_ >> static_cast<unsigned>(aov) & 1) != 0; }
  constexpr void add(Aov aov) { bits_ |= 1u << static_cast<unsigned>(aov); }
  template <typename... Aovs>
  constexpr bool has_any(Aovs... aovs) const {
    return (has(aovs) || ...);
  }
  // Groups that are summed apart.
  constexpr bool light() const {
    using enum Aov;
    return has_any(kDirectDiffuse, kDirectSpecular, kIndirectDiffuse, kIndirectSpecular, kEmission);
  }
  constexpr bool motion() const { return has_any(Aov::kForward, Aov::kBackward, Aov::kMotionCurve); }
  constexpr bool cost() const { return has_any(Aov::kNodeVisits, Aov::kPrimitiveTests); }
  constexpr bool crypto() const {
    using enum Aov;
    return has_any(kCryptoObject, kCryptoMaterial, kCryptoInstance);
  }

 private:
  std::uint32_t bits_ = 0;
};

}  // namespace msbvh
