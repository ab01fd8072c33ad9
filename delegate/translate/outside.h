// What lies wholly outside of the picture throughout the shutter, so that shadows and bounces alone can show
// it: its motion may stray further than that of what is seen.
#pragma once

#include "delegate/translate/fit.h"
#include "delegate/translate/view_volume.h"

namespace msbvh::translate {

struct Outside {
  ViewVolume view;
  double coarser = 1.0;  // times the motion tolerance

  double tolerance(const FitSettings& settings) const { return settings.tolerance * coarser; }
};

// Whether a coarser tolerance may make anything better: what moves has two keys at least.
inline bool may_be_coarser(std::size_t fine_keys, double fine_error, double fine_tolerance) {
  return fine_keys > 2 || fine_error > fine_tolerance;
}

// Whether to take the track within the coarser tolerance in place of the one within the finer: for fewer keys
// alone, or where the finer tolerance was missed.
inline bool is_worth_it(std::size_t coarse_keys, std::size_t fine_keys, double fine_error,
                        double fine_tolerance) {
  return coarse_keys < fine_keys || fine_error > fine_tolerance;
}

}  // namespace msbvh::translate
