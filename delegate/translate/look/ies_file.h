// Photometric data files of luminaires: ANSI/IES LM-63 (1986 to 2019).
#pragma once

#include <string_view>

#include "core/scene/ies_profile.h"

namespace msbvh::translate {

// Of photometric type C, the one that luminaires have; the symmetry of what is given fills all directions.
// Throws Error, which says what was found and what is expected, for anything else.
IesProfile parse_ies(std::string_view text);

}  // namespace msbvh::translate
