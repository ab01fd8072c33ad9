// Where what a tree holds is at a time, in double precision: what the oracle and the probes go by.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/base/affine.h"
#include "core/bvh/bvh.h"
#include "core/motion/bezier.h"

namespace msbvh {

// A track at a time in [0, 1]: `at(control)` is its value at a control.
template <typename At>
auto track_at(const TrackForm& form, double u, const At& at) {
  if (!form.moving()) return at(0);
  const double scaled = u * form.segments;
  const std::uint32_t key = std::min(static_cast<std::uint32_t>(scaled), form.segments - 1);
  return bezier([&](std::uint32_t i) { return at(key * form.degree + i); }, form.degree, scaled - key);
}

// In the mesh's own space.
inline Vec3d vertex_at(const TriangleMesh& mesh, std::uint32_t vertex, double u) {
  return track_at(mesh.form(), u, [&](std::uint32_t c) { return Vec3d(mesh.control_positions(c)[vertex]); });
}

// From the object's space to that of `bvh`.
inline Affine3d map_at(const Bvh& bvh, const Instance& instance, double u) {
  const Affine3f* controls = bvh.controls_of(instance);
  return track_at(instance.form, u, [&](std::uint32_t c) { return Affine3d(controls[c]); });
}

// The time in an object's or instance's own time, as the kernels see it; none where it is not there. Null:
// the shutter's.
inline std::optional<double> local_time(const TimeRemap* time_remap, double u) {
  if (!time_remap || time_remap->is_shutter()) return u;
  float local = 0.0f;
  return time_remap->at(static_cast<float>(u), local) ? std::optional<double>(local) : std::nullopt;
}

}  // namespace msbvh
