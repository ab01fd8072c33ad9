// Parts of the shutter: where what is held has which value, and where several things are visible at once.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Nothing given: the whole shutter.
using Visibility = std::optional<std::vector<VisibleInterval>>;

// From each time until the next; the last one ends behind the closing, which is part of it. Increasing times,
// the first at the opening or before.
std::vector<VisibleInterval> intervals_between(std::span<const double> begins01);

// Of something whose visibility is `shown[i]` from `begins01[i]` on. Not given where it is always visible; no
// intervals where it never is.
Visibility visible_intervals(std::span<const double> begins01, std::span<const bool> shown);

// Where both are visible.
Visibility common_intervals(const Visibility& a, const Visibility& b);

}  // namespace msbvh::translate
