// USD primvars to one value for each element of a triangle mesh.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/tessellation.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {

// The largest colour, that of half floats: a path multiplies one by the next, and an overflow would leave
// pixels that are no numbers.
inline constexpr float kMaxColor = 65504.0f;
inline bool is_color(float value) { return std::abs(value) <= kMaxColor; }  // false for NaN too
inline bool is_color(const Vec3f& value) {
  return is_color(value.x) && is_color(value.y) && is_color(value.z);
}

// Which authored value belongs to each element of the triangle mesh. Shared by all time samples of a primvar.
struct PrimvarMap {
  Interpolation interpolation = Interpolation::kConstant;
  std::vector<std::uint32_t> source;  // one index into the authored values for each element
};

// Expands `interpolation` (USD's token) and indices: uniform to one a triangle, faceVarying to three a
// triangle in the order of its vertices, varying to vertex. `value_count` values are authored. Sizes that do
// not fit the interpolation, indices out of range and unknown tokens are rejected: nothing is returned.
std::optional<PrimvarMap> map_primvar(const std::string& token, std::size_t value_count,
                                      std::span<const int> indices, const Triangulation& mesh,
                                      const std::string& attribute, PrimLog& log);

// A primvar, ready for the scene: with one key, or with as many as it takes to follow its samples
// (primvar_track.h), refined as the mesh is. One that does not fit or has a value at the frame that is no
// colour is left out, with a warning.
template <typename T>
Primvar<T> flattened(const PrimvarInput<T>& input, const Tessellation& mesh, const std::string& attribute,
                     PrimLog& log, std::uint32_t max_segments);

extern template Primvar<Vec3f> flattened(const PrimvarInput<Vec3f>&, const Tessellation&, const std::string&,
                                         PrimLog&, std::uint32_t);
extern template Primvar<float> flattened(const PrimvarInput<float>&, const Tessellation&, const std::string&,
                                         PrimLog&, std::uint32_t);

}  // namespace msbvh::translate
