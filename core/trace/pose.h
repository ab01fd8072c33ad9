// Where what a tree holds is at a time, in double precision: what the oracle and the probes go by.
#pragma once

#include <algorithm>
#include <cmath>
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

// The largest of what `size(control)` says of the controls that count at this time: what interpolation rounds
// is a share of it, however small the interpolated value is.
template <typename Size>
double largest_control(const TrackForm& form, double u, const Size& size) {
  if (!form.moving()) return size(0);
  const std::uint32_t key = std::min(static_cast<std::uint32_t>(u * form.segments), form.segments - 1);
  double most = 0.0;
  for (std::uint32_t i = 0; i <= form.degree; ++i) most = std::max(most, size(key * form.degree + i));
  return most;
}
inline double largest_coordinate(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
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
