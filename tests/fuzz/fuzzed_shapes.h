// Geometry of every kind that the core takes, made of a fuzzer's bytes.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/affine.h"
#include "core/bvh/bvh.h"
#include "core/geometry/curve_set.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/point_set.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"
#include "tests/fuzz/fuzzed_data.h"

namespace msbvh::fuzz {

// The most values that an array over all controls has: what verify() and the oracle take grows with them.
inline constexpr std::uint32_t kMostValues = 1500;

TrackForm fuzzed_form(FuzzedData& data);
// Elements a control, so that there are few where controls are many.
std::uint32_t fuzzed_count(FuzzedData& data, const TrackForm& form, std::uint32_t most);
TimeRemap fuzzed_time_remap(FuzzedData& data);

// Whether what is placed stays within the coordinates that a geometry may have. The core does not look: what
// reaches farther is traced, but not to the oracle's error.
bool stays_in_reach(const Bvh& object, std::span<const Affine3f> world_from_object);

// `topology`: what a mesh of the frame before had, so that a tree may be refitted; null for another one.
TriangleMesh fuzzed_mesh(FuzzedData& data, const TriangleMesh* topology = nullptr);
GridMesh fuzzed_grids(FuzzedData& data, const GridMesh* topology = nullptr);
CurveSet fuzzed_curves(FuzzedData& data, const CurveSet* topology = nullptr);
PointSet fuzzed_points(FuzzedData& data, const PointSet* topology = nullptr);

}  // namespace msbvh::fuzz
