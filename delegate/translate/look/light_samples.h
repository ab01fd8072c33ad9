// A light over the shutter: which of its values move, and what it gives at each of its places.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "delegate/translate/inputs.h"
#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/sample/motion_source.h"

namespace msbvh::translate {

// Of its largest value over the shutter: where a size passes 0, it is taken as that share of it. A light
// without any size is another kind of light, whose radiance has another unit.
inline constexpr double kSmallestShare = 1e-3;

// A light's inputs at T times of the shutter, increasing; one where nothing changes.
struct LightSamples {
  std::vector<double> times01;
  std::vector<Vec3d> emission;  // light_emission(): before normalisation
  std::vector<LightNumbers> numbers;
  std::vector<bool> normalize;  // inputs:normalize

  // Nothing but the transform may change.
  bool still() const { return times01.size() == 1; }
};

// What turns a light off for a part of the shutter.
struct LightSwitches {
  std::vector<bool> visible;  // [T]: what visibility says of the prim and its ancestors
  std::optional<std::vector<VisibleInterval>> shown{};  // where its instances are visible; not given: always

  bool on(std::size_t time, double time01) const;
};

// Times inside the shutter at which instances appear or disappear.
std::vector<double> switch_times01(std::span<const VisibleInterval> shown);

// The values of a light, wherever it stands.
class SampledLight {
 public:
  // Still. Throws Error for anything but one time.
  explicit SampledLight(LightSamples at_frame);
  // `at_frame` is the light at the frame, where no switch counts; `over_shutter` is read at value_times().
  // Throws Error where numbers of values differ.
  SampledLight(LightSamples at_frame, LightSamples over_shutter, const LightSwitches& switches);

  const LightSamples& at_frame() const { return at_frame_; }
  // 0 emission while it is off, no size that passes 0; one time where all are the same.
  const LightSamples& over_shutter() const { return over_shutter_; }

 private:
  LightSamples at_frame_, over_shutter_;
};

// Where the transform of lights that move together is evaluated, for lines between: [0] where still.
std::vector<double> light_times01(const MotionSource& motion, bool held);

// One of the motion's lights. `times01` are light_times01(), `frame01` is the frame's time or the shutter's
// end next to it. Values are sampled only where they change. A normalised light is as bright as its area in
// the world allows: where it scales, its radiance moves with the transform.
LightInput placed_light(LightKind kind, const SampledLight& light, const MotionSource& motion,
                        std::uint32_t which, std::span<const double> times01, double frame01);

// Whether lengths scale evenly and angles stay, but for what single precision rounds; true of NaN, which
// others report.
bool is_similarity(const Matrix4d& matrix);

}  // namespace msbvh::translate
