// Time remaps: how the shutter's time maps to an object's own.
//
// Keys lie at i / 2^k of a track's time. Where motion has breakpoints at times that are no such fraction
// (samples on whole frames under an asymmetric shutter), jumps (held samples), or shows only for a part of
// the shutter (visibility), the object gets a time remap of its own: a monotone, piecewise linear map from
// the shutter's time, under which the breakpoints fall on keys. A jump skips the segment between two keys; a
// hidden piece shows nothing. Everything below the object, boxes and vertices, sees the one time that the
// time remap says, so that the invariants of a tree hold unchanged in it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace msbvh {

// From `begin` (shutter time) until the next piece's: local time runs from `from` to `to`, both in [0, 1].
struct TimeRemapPiece {
  float begin = 0.0f;
  float from = 0.0f, to = 1.0f;
  bool visible = true;
  constexpr bool operator==(const TimeRemapPiece&) const = default;
};

// No pieces: the shutter's own time. Else the first begins at 0 and they increase; half-open, the last one
// includes u = 1.
struct TimeRemap {
  std::vector<TimeRemapPiece> pieces;

  bool is_shutter() const { return pieces.empty(); }
  bool operator==(const TimeRemap&) const = default;

  std::size_t piece_at(float u) const {
    const auto after =
        std::upper_bound(pieces.begin(), pieces.end(), u,
                         [](float time, const TimeRemapPiece& piece) { return time < piece.begin; });
    return after == pieces.begin() ? 0 : std::size_t(after - pieces.begin()) - 1;
  }
  double end_of(std::size_t piece) const {
    return piece + 1 < pieces.size() ? double(pieces[piece + 1].begin) : 1.0;
  }
  // False where nothing shows. Written in double and rounded once, so that `local` errs by 2^-25 at most.
  bool at(float u, float& local) const {
    if (is_shutter()) {
      local = u;
      return true;
    }
    const std::size_t i = piece_at(u);
    const TimeRemapPiece& piece = pieces[i];
    const double length = end_of(i) - double(piece.begin);
    const double w = length > 0.0 ? (double(u) - double(piece.begin)) / length : 0.0;
    local = static_cast<float>((1.0 - w) * double(piece.from) + w * double(piece.to));
    return piece.visible;
  }
};

// Pieces begin at 0 and increase, within [0, 1]; local times lie in [0, 1] and do not decrease within a
// piece.
inline bool is_valid_time_remap(const TimeRemap& time_remap) {
  for (std::size_t i = 0; i < time_remap.pieces.size(); ++i) {
    const TimeRemapPiece& p = time_remap.pieces[i];
    if (i == 0 ? p.begin != 0.0f : !(p.begin > time_remap.pieces[i - 1].begin)) return false;
    if (!(p.begin <= 1.0f && p.from >= 0.0f && p.from <= p.to && p.to <= 1.0f)) return false;
  }
  return true;
}

}  // namespace msbvh
