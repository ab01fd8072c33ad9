#include "delegate/translate/mesh.h"

#include <algorithm>
#include <cmath>

#include "delegate/translate/array_samples.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/normals.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/transform_fit.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {
namespace {

constexpr const char* kTransform = "xformOpOrder";
constexpr const char* kPoints = "points";

bool has_nothing_to_draw(const MeshInput& input) {
  return input.face_vertex_counts.empty() && input.face_vertex_indices.empty();
}

bool check(const MeshInput& input, PrimLog& log) {
  return check_transform(input.world_from_object, kTransform, log) &&
         check_array(input.points, kPoints, log) &&
         check_topology(input, input.points.samples.front().values.size(), log);
}

// Single precision holds 1e38, but products of coordinates must not overflow.
bool check_range(const Box3d& box, PrimLog& log) {
  const Vec3d largest = max(abs(box.lo), abs(box.hi));
  const double found = std::max({largest.x, largest.y, largest.z});
  if (found <= double(kMaxCoordinate)) return true;
  return log.reject(kPoints, message("a coordinate reaches ", found, "; expected at most 2^60 in size"));
}

constexpr const char* kJumps = " (held samples jump inside the shutter)";

TriangleMesh shape_of(const MovingArray& points, std::uint32_t segments, const Triangulation& topology,
                      const std::string& name) {
  TriangleMesh shape;
  shape.name = name;
  shape.segments = segments;
  shape.vertex_count = std::uint32_t(points.size());
  shape.positions = point_keys(points, segments);
  shape.triangles = topology.triangles;
  return shape;
}

void add_primvars(const MeshInput& input, const Triangulation& topology, const TransformTrack& transform,
                  const MeshTarget& target, Mesh& mesh, PrimLog& log) {
  mesh.normals = authored_normals(input, topology, transform, target.settings.max_segments, log);
  if (!mesh.normals.authored() && input.computed_normals == Normals::kSmooth) {
    mesh.normals = smooth_normals(mesh.shape);
  }
  PrimLog optional = log.of_optional_part();
  const std::uint32_t most = target.settings.max_segments;
  mesh.display_color = flattened(input.display_color, topology, "primvars:displayColor", optional, most);
  mesh.display_opacity =
      flattened(input.display_opacity, topology, "primvars:displayOpacity", optional, most);
  mesh.material = input.material;
  if (mesh.material != kNone && mesh.material >= target.material_count) {
    optional.reject("material:binding", message("found material ", mesh.material, "; expected less than ",
                                                target.material_count));
    mesh.material = kNone;
  }
}

std::optional<TranslatedMesh> in_moving_transform(const MeshInput& input, const ArrayTrack& points,
                                                  const TransformTrack& world_from_object,
                                                  const Triangulation& topology, MeshTarget& target,
                                                  PrimLog& log) {
  const Vec3d shift = exact_origin(bounds({points, TransformTrack(Affine3d{})}));
  const MovingArray still{points, TransformTrack(rebased(Affine3d{}, {}, shift))};
  const TransformTrack world_from_mesh = world_from_object.rebased(shift, *target.origin);
  const Box3d box = bounds(still);
  if (!check_range(box, log) || !check_range(bounds(box, world_from_mesh), log)) return std::nullopt;
  const TransformFitter fitter(world_from_mesh.times01(), *target.measure, target.settings);
  const Fit fit = fitter.fit(world_from_mesh.maps(), corners_of(box));
  report_fit(fit, target.settings.tolerance, kTransform, "the motion", "", log);

  TranslatedMesh result;
  result.mesh.shape = shape_of(still, 0, topology, input.path);
  add_primvars(input, topology, still.transform, target, result.mesh, log);
  result.track = {input.path, fit.segments, true, fit.error};
  result.world_from_mesh.resize(key_count(fit.segments));
  fitter.keys(world_from_mesh.maps(), fit.segments, result.world_from_mesh.data());
  return result;
}

std::optional<TranslatedMesh> baked(const MeshInput& input, const ArrayTrack& points,
                                    const TransformTrack& transform, const Triangulation& topology,
                                    MeshTarget& target, PrimLog& log) {
  if (!target.origin) target.origin = exact_origin(bounds({points, transform}));
  const MovingArray moving{points, transform.rebased({}, *target.origin)};
  const Box3d box = bounds(moving);
  if (!check_range(box, log)) return std::nullopt;
  const Fit fit = fit_points(
      moving, target.measure ? *target.measure : ScreenMeasure::filled_by(box, target.width, target.height),
      target.settings);
  report_fit(fit, target.settings.tolerance, kPoints, "the motion", points.jumps() ? kJumps : "", log);

  TranslatedMesh result;
  result.mesh.shape = shape_of(moving, fit.segments, topology, input.path);
  add_primvars(input, topology, moving.transform, target, result.mesh, log);
  result.track = {input.path, fit.segments, false, fit.error};
  return result;
}

}  // namespace

Vec3d exact_origin(const Box3d& box) {
  Vec3d origin;
  for (int axis = 0; axis < 3; ++axis) {
    const double nearest = std::min(std::abs(box.lo[axis]), std::abs(box.hi[axis]));
    const bool beside_zero = box.lo[axis] > 0.0 || box.hi[axis] < 0.0;
    if (beside_zero && nearest >= box.hi[axis] - box.lo[axis]) origin[axis] = float(box.center()[axis]);
  }
  return origin;
}

std::optional<TranslatedMesh> translate_mesh(const MeshInput& input, MeshTarget& target, PrimLog& log) {
  if (has_nothing_to_draw(input) || !check(input, log)) return std::nullopt;
  const ArrayTrack points(input.points);
  const TransformTrack transform(input.world_from_object);
  const Triangulation topology = triangulate(input, points.at(0.0).size(), log);
  if (topology.triangles.empty()) return std::nullopt;
  const bool in_world = target.measure != nullptr;
  if (in_world && points.is_still() && !transform.is_still() && !transform.is_singular_somewhere()) {
    return in_moving_transform(input, points, transform, topology, target, log);
  }
  return baked(input, points, transform, topology, target, log);
}

}  // namespace msbvh::translate
