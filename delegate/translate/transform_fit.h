// Tracks of affine maps: the cheapest that a moving object, instance or light needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/instance_chain.h"
#include "delegate/translate/screen_measure.h"

namespace msbvh::translate {

// Where the maps lead: from an object's stored coordinates to the frame's world, and how they are measured.
struct MapTarget {
  Vec3d object_origin;                 // of the stored coordinates, in the object's own space
  Vec3d world_origin;                  // of the frame, in stage space
  Box3d box;                           // of the stored coordinates
  double sampling_error_pixels = 0.0;  // of the maps themselves, counted against the tolerance
};

// Fits the maps of a chain, one instance after the other. Thread-safe: what instances share, the instants at
// which candidates pass through the motion and are tested, is prepared once.
class TransformFitter {
 public:
  TransformFitter(const InstanceChain& chain, const MapTarget& target, const ScreenMeasure& measure,
                  const FitSettings& settings);

  enum class Fate : std::uint8_t {
    kDrawn,
    kNotFinite,
    kFlat,     // singular throughout, but not a line or a point
    kVanished  // a line or a point throughout
  };
  struct Verdict {
    Fate fate = Fate::kDrawn;
    std::uint32_t track = 0;  // 0 still, else 1 + the index of a candidate
    double error = 0.0;       // pixels
  };
  Verdict judge(std::size_t instance) const;
  // By another tolerance than that of the settings, in pixels.
  Verdict judge(std::size_t instance, double tolerance) const;

  std::uint32_t track_count() const { return std::uint32_t(candidates_.size() + 1); }
  TrackForm form(std::uint32_t track) const;
  TimeRemap time_remap(std::uint32_t track) const;
  // form(track).controls() maps.
  void controls(std::size_t instance, std::uint32_t track, Affine3f* out) const;

 private:
  struct Test {
    double w;  // in the segment
    InstanceChain::Instant instant;
    ScreenInstant screen;
    std::size_t dense = 0;  // the number of the dense time that it is at, or 0, which counts for all strides
  };
  struct Segment {
    bool used = true;
    std::vector<InstanceChain::Instant> nodes;
    std::vector<Test> tests;
  };
  struct Prepared {
    std::once_flag once;
    std::vector<Segment> segments;
  };
  struct Probe {
    InstanceChain::Instant instant;
    ScreenInstant screen;
  };
  // Where it is seen whether a motion repeats: a time, and the same place in the first period.
  struct Echo {
    InstanceChain::Instant instant, first;
    ScreenInstant screen;
  };
  struct Period {
    double period01;
    std::vector<Echo> echoes;
  };

  void add_period(double period01);
  const std::vector<Segment>& prepared(std::size_t candidate) const;
  void prepare(std::size_t candidate) const;
  Affine3d map(const InstanceChain::Instant& instant, std::size_t instance) const;
  double still_error(std::size_t instance, const std::vector<Affine3d>& probes, double limit) const;
  // By how much a motion fails to repeat.
  double period_error(std::size_t instance, double period01, double limit) const;
  double error(std::size_t instance, std::size_t candidate, double limit) const;
  double moving_error(std::size_t instance, std::size_t candidate, double limit) const;
  double blur(std::size_t instance, std::size_t candidate) const;
  const std::vector<InstanceChain::Instant>& blur_instants() const;
  std::vector<Affine3d> probe_maps(std::size_t instance) const;
  bool has_representable_controls(std::size_t instance, std::uint32_t track) const;

  const InstanceChain& chain_;
  MapTarget target_;
  BoxCorners corners_;
  const ScreenMeasure& measure_;
  double tolerance_;  // pixels
  std::vector<Breakpoint> breakpoints_;
  std::vector<double> dense01_;
  std::vector<Candidate> candidates_;
  std::vector<Probe> probes_;  // the first is the shutter's centre
  std::vector<Probe> dense_;   // at dense01_
  std::vector<Period> periods_;
  mutable std::vector<Prepared> prepared_;
  mutable std::once_flag blur_once_;
  mutable std::vector<InstanceChain::Instant> blur_;  // at blur_time01(0), (1), ...
};

}  // namespace msbvh::translate
