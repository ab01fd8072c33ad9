// Photometric data files of luminaires: ANSI/IES LM-63 (1986 to 2019).
#pragma once

#include <string_view>

#include "core/scene/ies_profile.h"

namespace msbvh::translate {

// Of photometric type C, the one that most luminaires have; of type B or A, of floodlights and headlamps,
// resampled to a degree as type C has it. The symmetry of what is given fills all directions. Throws Error,
// which says the line, what was found and what is expected, for anything else.
IesProfile parse_ies(std::string_view text);

}  // namespace msbvh::translate
