// The keys of a primvar whose values change inside the shutter.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

template <typename T>
struct PrimvarTrack {
  std::uint32_t segments = 0;
  std::vector<T> values;  // [key_count(segments)][values of a sample], key-major, before indices
};

// The fewest segments within the input's tolerance; where values jump (two samples within kJumpTime01,
// value_track.h), within that share of the shutter's worth. Samples that do not fit together leave a warning,
// and `input.values` are held.
template <typename T>
PrimvarTrack<T> fit_primvar(const PrimvarInput<T>& input, std::uint32_t max_segments,
                            const std::string& attribute, PrimLog& log);

extern template PrimvarTrack<Vec3f> fit_primvar(const PrimvarInput<Vec3f>&, std::uint32_t, const std::string&,
                                                PrimLog&);
extern template PrimvarTrack<float> fit_primvar(const PrimvarInput<float>&, std::uint32_t, const std::string&,
                                                PrimLog&);

}  // namespace msbvh::translate
