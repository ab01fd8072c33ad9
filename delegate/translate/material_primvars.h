// The primvars that a prim's materials read by their names.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/appearance.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/material_table.h"

namespace msbvh::translate {

// PrimvarInput::tolerance of what materials read: of coordinates, half a texel of 8192.
inline constexpr double kMaterialTolerance = 1.0 / 16384.0;

// Of those that a prim brings along, those that its materials, or the materials of its faces, read, or that
// are kept of all; by increasing names. `flattened(named)` gives the values on what the prim became; none
// where they do not fit.
std::vector<msbvh::SurfacePrimvar> material_primvars(
    const MeshInput& input, const MaterialTable& materials,
    const std::function<Primvar<Vec3f>(const NamedPrimvar&)>& flattened);

}  // namespace msbvh::translate
