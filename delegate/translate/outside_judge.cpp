#include "delegate/translate/outside_judge.h"

#include <vector>

#include "core/base/affine.h"

namespace msbvh::translate {

OutsideJudge::OutsideJudge(const TransformFitter& fitter, const FitSettings& settings, const Box3d& box,
                           const Outside* outside)
    : fitter_(fitter), settings_(settings), corners_(corners_of(box)), outside_(outside) {}

Judgement OutsideJudge::judge(std::size_t instance, const TransformFitter::Verdict& fine) const {
  const Judgement result{fine, settings_.tolerance};
  // What stands still has no keys to save.
  if (!outside_ || fine.fate != TransformFitter::Fate::kDrawn || fine.track == 0) return result;
  if (!is_outside(instance, fine.track)) return result;
  const double tolerance = outside_->tolerance(settings_);
  const std::uint32_t fine_keys = fitter_.form(fine.track).controls();
  if (!may_be_coarser(fine_keys, fine.error, settings_.tolerance)) return {fine, tolerance, true};
  const TransformFitter::Verdict coarse = fitter_.judge(instance, tolerance);
  if (coarse.fate != fine.fate || !is_outside(instance, coarse.track)) return result;
  const std::uint32_t keys = fitter_.form(coarse.track).controls();
  if (!is_worth_it(keys, fine_keys, fine.error, settings_.tolerance)) return {fine, tolerance, true};
  return {coarse, tolerance, true, keys < fine_keys ? fine_keys - keys : 0};
}

bool OutsideJudge::is_outside(std::size_t instance, std::uint32_t track) const {
  std::vector<Affine3f> controls(fitter_.form(track).controls());
  fitter_.controls(instance, track, controls.data());
  Box3d hull = bounds_of(corners_, Affine3d(controls.front()));
  if (!outside_->view.misses(hull)) return false;  // as most do that are in the picture
  for (const Affine3f& map : controls) hull.grow(bounds_of(corners_, Affine3d(map)));
  return outside_->view.misses(hull);
}

}  // namespace msbvh::translate
