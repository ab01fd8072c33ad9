// The track of each of many things that a chain of maps places: within the motion tolerance or, of what lies
// outside of the picture, within a coarser one.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/box.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/outside.h"
#include "delegate/translate/transform_fit.h"

namespace msbvh::translate {

struct Judgement {
  TransformFitter::Verdict verdict;
  double tolerance = 0.0;        // pixels, that its error is held to
  bool outside = false;          // it moves, and is wholly outside of the picture throughout the shutter
  std::uint32_t keys_saved = 0;  // by the coarser tolerance

  bool is_beyond() const { return verdict.error > tolerance; }
};

// A thing is outside of the picture where the hull of its box under each control of its track is
// (view_volume.h): both of the track that it would have within the motion tolerance, and of the one that it
// gets. So camera rays meet the same things as without the coarser tolerance, at the same places.
class OutsideJudge {
 public:
  // `box`: of all that `fitter` places, in its stored coordinates, at all controls of its own motion.
  // `outside` null: one tolerance for all. Borrows both.
  OutsideJudge(const TransformFitter& fitter, const FitSettings& settings, const Box3d& box,
               const Outside* outside);

  // Thread-safe.
  Judgement judge(std::size_t instance) const { return judge(instance, fitter_.judge(instance)); }
  // `fine`: fitter.judge(instance).
  Judgement judge(std::size_t instance, const TransformFitter::Verdict& fine) const;

 private:
  bool is_outside(std::size_t instance, std::uint32_t track) const;

  const TransformFitter& fitter_;
  FitSettings settings_;
  BoxCorners corners_;
  const Outside* outside_;
};

}  // namespace msbvh::translate
