// Which samples of a primvar over the shutter count.
#pragma once

#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Samples that cannot be interpolated, since their number changes or one is not finite, give way to the
// frame's values, with a warning; those that all equal the frame's say nothing and go too. Where the frame's
// own values are not finite the samples go without a word: the translator says so.
template <typename T>
void settle_samples(PrimvarInput<T>& primvar, const std::string& attribute, PrimLog& log);

extern template void settle_samples(PrimvarInput<float>&, const std::string&, PrimLog&);
extern template void settle_samples(PrimvarInput<Vec3f>&, const std::string&, PrimLog&);

// Of curves, points and meshes that reach beyond their points by half their width: the largest of all
// samples, 1 where none are authored.
double largest_width(const PrimvarInput<float>& widths);

}  // namespace msbvh::translate
