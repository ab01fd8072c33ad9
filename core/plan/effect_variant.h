// Code that is compiled once for each subset of some effects and chosen by those that are on, so that what is
// off costs no instruction.
#pragma once

#include "core/plan/known_effects.h"

namespace msbvh {

// No effect at all.
inline constexpr EffectSet kPlain{};

namespace detail {

template <EffectSet kOn, typename Make>
auto variant(EffectSet, const Make& make) {
  return make.template operator()<kOn>();
}
template <EffectSet kOn, Effect kFirst, Effect... kRest, typename Make>
auto variant(EffectSet on, const Make& make) {
  if constexpr (kKnownEffects.has(kFirst)) {
    if (on.has(kFirst)) return variant<kOn.with(kFirst), kRest...>(on, make);
  }
  return variant<kOn, kRest...>(on, make);
}

}  // namespace detail

// What make.operator()<kOn>() returns, where kOn are those of kEffects that `on` has. Variants with an effect
// that is left out of the build are not compiled.
template <Effect... kEffects, typename Make>
auto variant_for(EffectSet on, const Make& make) {
  return detail::variant<kPlain, kEffects...>(on, make);
}

}  // namespace msbvh
