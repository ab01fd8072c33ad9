#include "delegate/translate/mesh.h"

#include <algorithm>
#include <cmath>

#include "delegate/translate/instance_chain.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/normals.h"
#include "delegate/translate/point_motion.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/tessellation.h"
#include "delegate/translate/transform_fit.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {
namespace {

constexpr const char* kTransform = "xformOpOrder";
constexpr const char* kPoints = "points";

bool has_nothing_to_draw(const MeshInput& input) {
  return input.face_vertex_counts.empty() && input.face_vertex_indices.empty();
}

// Single precision holds 1e38, but products of coordinates must not overflow.
bool check_range(const Box3d& box, PrimLog& log) {
  const Vec3d largest = max(abs(box.lo), abs(box.hi));
  const double found = std::max({largest.x, largest.y, largest.z});
  if (found <= double(kMaxCoordinate)) return true;
  return log.reject(kPoints, message("a coordinate reaches ", found, "; expected at most 2^60 in size"));
}

// Controls of curves lie up to five times as far out as the curve.
bool check_controls(const TriangleMesh& shape, PrimLog& log) {
  Box3d box;
  for (std::size_t i = 0; i < shape.position_count(); ++i) box.grow(Vec3d(shape.positions[i]));
  return check_range(box, log);
}

// A mesh's shape and, of a refined one, its cage's points at the same controls.
struct Shape {
  TriangleMesh mesh;
  std::vector<Vec3f> cage{};
};

std::vector<Vec3f> refined_controls(const RefinedMesh& refined, const std::vector<Vec3f>& cage,
                                    std::uint32_t controls) {
  std::vector<Vec3f> out(std::size_t(controls) * refined.point_count() + TriangleMesh::kGuard);
  std::vector<const float*> from;
  std::vector<float*> to;
  for (std::size_t c = 0; c < controls; ++c) {
    from.push_back(&cage[c * refined.cage().vertex_count].x);
    to.push_back(&out[c * refined.point_count()].x);
  }
  refined.at_points({}, 3, from, to);
  return out;
}

Shape shape_of(const MovingArray& points, const Candidate& track, const Tessellation& faces,
               const std::string& name) {
  Shape shape;
  TriangleMesh& mesh = shape.mesh;
  mesh.name = name;
  mesh.segments = track.form().segments;
  mesh.degree = track.form().degree;
  mesh.vertex_count = std::uint32_t(points.size());
  mesh.positions = point_controls(points, track);
  mesh.triangles = faces.triangles();
  if (const Refinement* refinement = faces.refinement()) {
    shape.cage = std::move(mesh.positions);
    mesh.vertex_count = refinement->mesh->point_count();
    mesh.positions = refined_controls(*refinement->mesh, shape.cage, mesh.form().controls());
  }
  return shape;
}

// One material a triangle, or the mesh's own where all triangles have the same.
void add_face_materials(const MeshInput& input, const Tessellation& topology, std::uint32_t material_count,
                        Mesh& mesh, PrimLog& optional) {
  const std::span<const int> given = input.face_materials;
  if (given.empty()) return;
  const auto largest = std::ranges::max_element(given);
  const std::size_t face_count = topology.polygons().face_count;
  if (given.size() != face_count || *largest >= std::int64_t(material_count)) {
    optional.reject("material:binding",
                    message("found ", given.size(), " materials of faces, the largest ", *largest,
                            "; expected ", face_count, " and less than ", material_count));
    return;
  }
  const auto of_face = [&](std::uint32_t face) {
    return given[face] < 0 ? kNone : std::uint32_t(given[face]);
  };
  mesh.material = of_face(topology.faces().front());
  const bool alike = std::ranges::all_of(topology.faces(),
                                         [&](std::uint32_t face) { return of_face(face) == mesh.material; });
  if (alike) return;
  mesh.triangle_materials.reserve(topology.faces().size());
  for (const std::uint32_t face : topology.faces()) mesh.triangle_materials.push_back(of_face(face));
}

Primvar<Vec3f> normals_of(const MeshInput& input, const Tessellation& topology, const NormalMotion& motion,
                          const Shape& shape, std::uint32_t max_segments, PrimLog& log) {
  if (const Refinement* refinement = topology.refinement())
    return limit_normals(*refinement->mesh, shape.cage, shape.mesh.form(), max_segments);
  Primvar<Vec3f> authored = authored_normals(input, topology.polygons(), motion, max_segments, log);
  if (authored.authored() || input.computed_normals != Normals::kSmooth) return authored;
  return smooth_normals(shape.mesh, max_segments);
}

void add_shape(const MeshInput& input, const Tessellation& topology, const NormalMotion& motion,
               const MeshTarget& target, Shape shape, Mesh& mesh, PrimLog& log) {
  const std::uint32_t most = target.settings.max_segments;
  mesh.normals = normals_of(input, topology, motion, shape, most, log);
  mesh.shape = std::move(shape.mesh);
  PrimLog optional = log.of_optional_part();
  mesh.display_color = flattened(input.display_color, topology, "primvars:displayColor", optional, most);
  mesh.display_opacity =
      flattened(input.display_opacity, topology, "primvars:displayOpacity", optional, most);
  mesh.material = input.material;
  if (mesh.material != kNone && mesh.material >= target.material_count) {
    optional.reject("material:binding", message("found material ", mesh.material, "; expected less than ",
                                                target.material_count));
    mesh.material = kNone;
  }
  add_face_materials(input, topology, target.material_count, mesh, optional);
  if (target.keep_faces) mesh.triangle_faces = topology.faces();
  if (topology.refinement()) mesh.cage_faces = std::uint32_t(topology.polygons().face_count);
}

void set_time_remap(const MeshInput& input, const TimeRemap& time_remap, TranslatedMesh& result) {
  result.time_remap = time_remap;
  if (!input.visible) return;
  result.time_remap = with_visibility(time_remap, *input.visible);
  result.track.hidden_partly = true;
  result.never_seen = std::ranges::none_of(result.time_remap.pieces, &TimeRemapPiece::visible);
}

// The one input of both ways to keep a mesh's motion.
struct MeshMotion {
  const MeshInput& input;
  const PointMotion& points;
  const TransformTrack& transform;
  const Triangulation& polygons;
};

ScreenMeasure measure_of(const MeshTarget& target, const Box3d& box) {
  if (target.measure) return *target.measure;
  if (target.pixels_per_unit > 0.0) return ScreenMeasure::constant(target.pixels_per_unit);
  return ScreenMeasure::filled_by(box, target.width, target.height);
}

// `points` in the world, which will have a track of so many controls.
Tessellation tessellated(const MeshMotion& motion, const MovingArray& points, const ScreenMeasure& measure,
                         std::uint32_t controls, const MeshTarget& target, PrimLog& log) {
  return tessellated(motion.input, motion.polygons, points, {target.edge_length_pixels, measure}, controls,
                     *target.refinements, log);
}

std::optional<TranslatedMesh> in_moving_transform(const MeshMotion& motion, MeshTarget& target,
                                                  PrimLog& log) {
  const auto& [input, points, transform, polygons] = motion;
  const Vec3d shift = exact_origin(bounds({points.track, TransformTrack(Affine3d{})}));
  const MovingArray still{points.track, TransformTrack(rebased(Affine3d{}, {}, shift))};
  const Box3d box = bounds(still);
  if (!check_range(box, log) || !check_range(bounds(box, transform.rebased(shift, *target.origin)), log)) {
    return std::nullopt;
  }
  const TransformSamples& samples = input.world_from_object;
  const std::vector<InstanceLevel> levels{{samples.times01,
                                           samples.matrices,
                                           samples.breakpoints01,
                                           samples.held,
                                           nullptr,
                                           {},
                                           samples.periods01}};
  const std::optional<InstanceChain> chain = InstanceChain::make(levels, log);
  if (!chain) return std::nullopt;
  const TransformFitter fitter(*chain, {shift, *target.origin, box, samples.error_pixels}, *target.measure,
                               target.settings);
  const TransformFitter::Verdict verdict = fitter.judge(0);
  if (verdict.fate == TransformFitter::Fate::kNotFinite) {
    log.reject(kTransform,
               "the motion has an element that is not finite or too large; expected finite numbers of at "
               "most 2^60 in size");
    return std::nullopt;
  }
  const TrackForm form = fitter.form(verdict.track);
  report_fit({form.segments, verdict.error}, target.settings, kTransform, "the motion", log);

  const MovingArray moving{points.track, transform.rebased({}, *target.origin)};
  const Tessellation topology = tessellated(motion, moving, *target.measure, 1, target, log);
  if (topology.triangles().empty()) return std::nullopt;
  TranslatedMesh result;
  const TimeLayout unmoved = TimeLayout::even(0);
  add_shape(input, topology, {still.transform, unmoved, points.frame_only}, target,
            shape_of(still, {unmoved, 1}, topology, input.path), result.mesh, log);
  result.track = {input.path, "transform", chain->rule()};
  result.track.set_form(form, fitter.time_remap(verdict.track));
  result.track.moving_transform = true;
  result.track.error_pixels = verdict.error;
  result.track.bytes = form.controls() * sizeof(Affine3f);
  result.world_from_mesh.resize(form.controls());
  fitter.controls(0, verdict.track, result.world_from_mesh.data());
  set_time_remap(input, fitter.time_remap(verdict.track), result);
  return result;
}

std::string rule_of(const PointMotion& points, const TransformTrack& transform) {
  const char* moved = "the transform by the stage's own evaluation";
  if (transform.is_still()) return points.rule;
  return points.track.is_still() ? moved : message(points.rule, "; ", moved);
}

std::optional<TranslatedMesh> baked(const MeshMotion& motion, MeshTarget& target, PrimLog& log) {
  const auto& [input, points, transform, polygons] = motion;
  if (!target.origin) target.origin = exact_origin(bounds({points.track, transform}));
  const MovingArray moving{points.track, transform.rebased({}, *target.origin)};
  const Box3d box = bounds(moving);
  if (!check_range(box, log)) return std::nullopt;
  const ScreenMeasure measure = measure_of(target, box);
  const PointFit fit = fit_points(moving, measure, target.settings);
  const TrackForm form = fit.track.form();
  report_fit({form.segments, fit.error}, target.settings, kPoints, "the motion", log);

  const Tessellation topology = tessellated(motion, moving, measure, form.controls(), target, log);
  if (topology.triangles().empty()) return std::nullopt;  // a boundary rule may leave no face a surface
  TranslatedMesh result;
  Shape shape = shape_of(moving, fit.track, topology, input.path);
  if (!check_controls(shape.mesh, log)) return std::nullopt;
  add_shape(input, topology, {moving.transform, fit.track.layout, points.frame_only}, target,
            std::move(shape), result.mesh, log);
  const bool by_transform = points.track.is_still() && !transform.is_still();
  result.track = {input.path, by_transform ? "transform" : points.source, rule_of(points, transform)};
  result.track.set_form(form, fit.track.layout.time_remap());
  result.track.error_pixels = fit.error;
  result.track.bytes = result.mesh.shape.position_count() * sizeof(Vec3f);
  set_time_remap(input, fit.track.layout.time_remap(), result);
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
  if (has_nothing_to_draw(input) || !check_transform(input.world_from_object, kTransform, log)) {
    return std::nullopt;
  }
  const std::optional<PointMotion> points = point_motion(input, log);
  if (!points || !check_topology(input, points->track.size(), log)) return std::nullopt;
  const TransformTrack transform(input.world_from_object);
  const Triangulation polygons = triangulate(input, points->track.size(), log);
  if (polygons.triangles.empty()) return std::nullopt;
  const bool in_world = target.measure != nullptr;
  const MeshMotion motion{input, *points, transform, polygons};
  const bool keeps_transform =
      in_world && points->track.is_still() && !transform.is_still() && !transform.is_singular_somewhere();
  return keeps_transform ? in_moving_transform(motion, target, log) : baked(motion, target, log);
}

}  // namespace msbvh::translate
