// A mesh on its way from Python to the translator: msbvh._core.MeshInput.
#pragma once

#include <nanobind/nanobind.h>
#include <vector>

#include "delegate/translate/inputs.h"
#include "delegate/usd/bindings/arguments.h"

namespace msbvh::python {

// Python objects under the names of translate::MeshInput, None where nothing is given. They are looked at
// when the mesh is handed down.
struct MeshObject {
  nanobind::object path, face_vertex_counts, face_vertex_indices, indices_name, hole_indices, left_handed;
  nanobind::object subdivision_scheme, interpolate_boundary, face_varying_linear, triangle_rule;
  nanobind::object crease_lengths, crease_indices, crease_sharpnesses, corner_indices, corner_sharpnesses;
  nanobind::object points, points_held, velocities, accelerations;
  nanobind::object frame01, seconds_per_shutter, velocity_scale;
  nanobind::object topology_varies, computed_points, stray, visible, transform;
  nanobind::object normals, normals_interpolation, normals_indices, computed_normals;
  nanobind::object display_color, display_opacity, named_primvars, displaced, material, face_materials;
  nanobind::object round, curve_type, curve_basis, curve_wrap, curve_vertex_counts, widths;
  nanobind::object curve_orders, curve_knots, curve_ranges, curve_weights;

  MeshObject();

  // What it borrows lives as long as `borrowed`. TypeError or ValueError, naming the attribute, for what does
  // not fit.
  translate::MeshInput input(Borrowed& borrowed) const;
};

// A dictionary from a primvar's name to what display_color is; None: none.
std::vector<translate::NamedPrimvar> named_from(const nanobind::object& given, const char* name_of_all,
                                                Borrowed& borrowed);

}  // namespace msbvh::python
