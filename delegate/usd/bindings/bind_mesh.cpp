// MeshInput: a mesh's attributes, set one by one, to translate::MeshInput.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "delegate/usd/bindings/attributes.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"
#include "delegate/usd/bindings/mesh_object.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

constexpr Attribute<MeshObject> kAttributes[] = {
    {"path", &MeshObject::path},
    {"face_vertex_counts", &MeshObject::face_vertex_counts},
    {"face_vertex_indices", &MeshObject::face_vertex_indices},
    {"indices_name", &MeshObject::indices_name},
    {"hole_indices", &MeshObject::hole_indices},
    {"left_handed", &MeshObject::left_handed},
    {"subdivision_scheme", &MeshObject::subdivision_scheme},
    {"interpolate_boundary", &MeshObject::interpolate_boundary},
    {"face_varying_linear", &MeshObject::face_varying_linear},
    {"triangle_rule", &MeshObject::triangle_rule},
    {"crease_lengths", &MeshObject::crease_lengths},
    {"crease_indices", &MeshObject::crease_indices},
    {"crease_sharpnesses", &MeshObject::crease_sharpnesses},
    {"corner_indices", &MeshObject::corner_indices},
    {"corner_sharpnesses", &MeshObject::corner_sharpnesses},
    {"points", &MeshObject::points},
    {"points_held", &MeshObject::points_held},
    {"velocities", &MeshObject::velocities},
    {"accelerations", &MeshObject::accelerations},
    {"frame01", &MeshObject::frame01},
    {"seconds_per_shutter", &MeshObject::seconds_per_shutter},
    {"velocity_scale", &MeshObject::velocity_scale},
    {"topology_varies", &MeshObject::topology_varies},
    {"computed_points", &MeshObject::computed_points},
    {"stray", &MeshObject::stray},
    {"visible", &MeshObject::visible},
    {"transform", &MeshObject::transform},
    {"normals", &MeshObject::normals},
    {"normals_interpolation", &MeshObject::normals_interpolation},
    {"normals_indices", &MeshObject::normals_indices},
    {"computed_normals", &MeshObject::computed_normals},
    {"display_color", &MeshObject::display_color},
    {"display_opacity", &MeshObject::display_opacity},
    {"named_primvars", &MeshObject::named_primvars},
    {"displaced", &MeshObject::displaced},
    {"material", &MeshObject::material},
    {"face_materials", &MeshObject::face_materials},
    {"round", &MeshObject::round},
    {"curve_type", &MeshObject::curve_type},
    {"curve_basis", &MeshObject::curve_basis},
    {"curve_wrap", &MeshObject::curve_wrap},
    {"curve_vertex_counts", &MeshObject::curve_vertex_counts},
    {"curve_orders", &MeshObject::curve_orders},
    {"curve_knots", &MeshObject::curve_knots},
    {"curve_ranges", &MeshObject::curve_ranges},
    {"curve_weights", &MeshObject::curve_weights},
    {"widths", &MeshObject::widths},
};

const nb::object& needed(const nb::object& given, const char* name) {
  return required(given, "MeshInput", name);
}

SubdivisionInput subdivision_from(const MeshObject& mesh, Borrowed& borrowed) {
  SubdivisionInput result;
  take(result.scheme, mesh.subdivision_scheme, "subdivision_scheme", "a str");
  take(result.interpolate_boundary, mesh.interpolate_boundary, "interpolate_boundary", "a str");
  take(result.face_varying_linear, mesh.face_varying_linear, "face_varying_linear", "a str");
  take(result.triangle_rule, mesh.triangle_rule, "triangle_rule", "a str");
  result.crease_lengths = borrowed.ints(mesh.crease_lengths, "crease_lengths");
  result.crease_indices = borrowed.ints(mesh.crease_indices, "crease_indices");
  result.crease_sharpnesses = borrowed.scalars(mesh.crease_sharpnesses, "crease_sharpnesses");
  result.corner_indices = borrowed.ints(mesh.corner_indices, "corner_indices");
  result.corner_sharpnesses = borrowed.scalars(mesh.corner_sharpnesses, "corner_sharpnesses");
  return result;
}

RoundInput::Kind round_kind_from(const nb::object& given) {
  if (given.is_none()) return RoundInput::Kind::kNone;
  const auto kind = value_from<std::string>(given, "round", "a str");
  if (kind == "curves") return RoundInput::Kind::kCurves;
  if (kind == "points") return RoundInput::Kind::kPoints;
  throw nb::value_error(("round: found '" + kind + "'; expected curves or points").c_str());
}

RoundInput round_from(const MeshObject& mesh, Borrowed& borrowed) {
  RoundInput result;
  result.kind = round_kind_from(mesh.round);
  take(result.topology.type, mesh.curve_type, "curve_type", "a str");
  take(result.topology.basis, mesh.curve_basis, "curve_basis", "a str");
  take(result.topology.wrap, mesh.curve_wrap, "curve_wrap", "a str");
  result.topology.vertex_counts = borrowed.ints(mesh.curve_vertex_counts, "curve_vertex_counts");
  result.topology.orders = borrowed.ints(mesh.curve_orders, "curve_orders");
  const auto doubles = [&](const nb::object& given, const char* name) {
    return given.is_none() ? std::span<const double>() : borrowed.doubles(given, name);
  };
  result.topology.knots = doubles(mesh.curve_knots, "curve_knots");
  result.topology.ranges = doubles(mesh.curve_ranges, "curve_ranges");
  result.topology.weights = doubles(mesh.curve_weights, "curve_weights");
  result.widths = borrowed.primvar<float>(mesh.widths, "widths");
  return result;
}

}  // namespace

std::vector<NamedPrimvar> named_from(const nb::object& given, const char* name_of_all, Borrowed& borrowed) {
  std::vector<NamedPrimvar> result;
  if (given.is_none()) return result;
  const auto primvars = value_from<nb::dict>(given, name_of_all, "a dict");
  for (const auto& [key, value] : primvars) {
    const auto name = value_from<std::string>(key, name_of_all, "names as str");
    result.push_back({name, borrowed.primvar<Vec3f>(value, name)});
  }
  return result;
}

MeshObject::MeshObject() { set_to_none(*this, kAttributes); }

MeshInput MeshObject::input(Borrowed& borrowed) const {
  MeshInput mesh;
  mesh.path = value_from<std::string>(needed(path, "path"), "path", "a str");
  mesh.round = round_from(*this, borrowed);
  if (mesh.round.kind == RoundInput::Kind::kNone) {
    mesh.face_vertex_counts =
        borrowed.ints(needed(face_vertex_counts, "face_vertex_counts"), "face_vertex_counts");
    mesh.face_vertex_indices =
        borrowed.ints(needed(face_vertex_indices, "face_vertex_indices"), "face_vertex_indices");
    take(mesh.indices_name, indices_name, "indices_name", "a str");
  }
  mesh.hole_indices = borrowed.ints(hole_indices, "hole_indices");
  take(mesh.left_handed, left_handed, "left_handed", "a bool");
  mesh.subdivision = subdivision_from(*this, borrowed);
  bool held = false;
  take(held, points_held, "points_held", "a bool");
  mesh.points = borrowed.samples(needed(points, "points"), "points", held);
  mesh.rates = {borrowed.samples(velocities, "velocities", held),
                borrowed.samples(accelerations, "accelerations", held)};
  take(mesh.time_remap.frame01, frame01, "frame01", "a float");
  take(mesh.time_remap.seconds_per_shutter, seconds_per_shutter, "seconds_per_shutter", "a float");
  take(mesh.time_remap.velocity_scale, velocity_scale, "velocity_scale", "a float");
  take(mesh.topology_varies, topology_varies, "topology_varies", "a bool");
  take(mesh.computed_points, computed_points, "computed_points", "a bool");
  take(mesh.stray, stray, "stray", "a float");
  mesh.visible = visible_from(visible);
  mesh.world_from_object =
      value_from<TransformSamples>(needed(transform, "transform"), "transform", "a TransformSamples");
  mesh.normals = borrowed.samples(normals, "normals", held);
  take(mesh.normals_interpolation, normals_interpolation, "normals_interpolation", "a str");
  mesh.normals_indices = borrowed.ints(normals_indices, "normals_indices");
  std::string computed = "faceted";
  take(computed, computed_normals, "computed_normals", "a str");
  mesh.computed_normals = computed_normals_from(computed);
  mesh.display_color = borrowed.primvar<Vec3f>(display_color, "display_color");
  mesh.display_opacity = borrowed.primvar<float>(display_opacity, "display_opacity");
  mesh.named_primvars = named_from(named_primvars, "named_primvars", borrowed);
  take(mesh.displaced, displaced, "displaced", "a bool");
  take(mesh.material, material, "material", "an int or None");
  mesh.face_materials = borrowed.ints(face_materials, "face_materials");
  return mesh;
}

void bind_mesh(nb::module_& m) { bind_attributes(m, "MeshInput", kAttributes); }

}  // namespace msbvh::python
