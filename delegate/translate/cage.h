// A mesh as the cage of a subdivision surface.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/subdivision/subdivision_mesh.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

struct InputCage {
  Cage cage;
  // Of face-varying primvars, by attribute: their place in Cage::face_varying.
  std::map<std::string, std::uint32_t> channels{};
  // The input's face and corner of each of the cage's; empty where none is left out.
  std::vector<std::uint32_t> faces{}, corners{};
};

// The input must have passed check_topology(). Faces of fewer than three vertices are left out, and what is
// wrong with creases and corners, with warnings. Nothing for a mesh of polygons (scheme none), or, with a
// warning, for a scheme that is unknown or does not fit the faces.
std::optional<InputCage> cage_of(const MeshInput& input, std::size_t point_count, PrimLog& log);

}  // namespace msbvh::translate
