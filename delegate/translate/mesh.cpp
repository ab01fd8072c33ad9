#include "delegate/translate/mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "delegate/translate/displace/displaced_shape.h"
#include "delegate/translate/drawn_box.h"
#include "delegate/translate/instance_chain.h"
#include "delegate/translate/mesh_shape.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/outside_judge.h"
#include "delegate/translate/point_motion.h"
#include "delegate/translate/round/round_shape.h"
#include "delegate/translate/stray/displaced_stray.h"
#include "delegate/translate/stray/stray.h"
#include "delegate/translate/tessellation.h"
#include "delegate/translate/transform_fit.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {
namespace {

constexpr const char* kTransform = "xformOpOrder";
constexpr const char* kPoints = "points";

bool is_round(const MeshInput& input) { return input.round.kind != RoundInput::Kind::kNone; }

bool has_nothing_to_draw(const MeshInput& input) {
  if (is_round(input)) {
    return std::ranges::all_of(input.points.samples, [](const ArraySample& s) { return s.values.empty(); });
  }
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

Box3d grown(const Box3d& box, double by) {
  const Vec3d margin{by, by, by};
  return {box.lo - margin, box.hi + margin};
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
  const FaceDisplacements& displacements;
  const RoundShape* round;  // null for a mesh
};

// False, with an error in the log, where its controls are too large.
bool add_round(const MeshMotion& motion, const MovingArray& points, const Candidate& track,
               const MeshTarget& target, TranslatedMesh& result, PrimLog& log) {
  PrimLog optional = log.of_optional_part();
  const std::uint32_t most = target.settings.max_segments;
  Appearance* look;
  if (motion.round->is_curves()) {
    look = &result.curves.emplace(
        motion.round->curves(motion.input, points, track, *target.materials, most, optional));
  } else {
    look = &result.points.emplace(
        motion.round->points(motion.input, points, track, *target.materials, most, optional));
  }
  look->material = material_of(motion.input, target, optional);
  return check_range(result.box(), log);
}

// With a key wherever widths and normals that change have one, in even time.
PointFit with_own_keys(PointFit fit, const MeshMotion& motion, const MovingArray& points, const Box3d& box,
                       const ScreenMeasure& measure, FitSettings settings) {
  const std::uint32_t needed =
      motion.round->needed_segments(points.transform, fit.track.layout, measure, box, settings);
  const TrackForm form = fit.track.form();
  if (needed == 0 || (fit.track.layout.is_even() && form.degree == 1 && form.segments >= needed)) return fit;
  settings.choice = {1, 1, std::max(needed, form.segments)};
  PointFit finer = fit_points(points, measure, settings);
  // Points that stand still need no keys of their own.
  if (!finer.track.form().moving()) finer.track = {TimeLayout::even(settings.choice.segments), 1};
  return finer;
}

ScreenMeasure measure_of(const MeshTarget& target, const Box3d& box) {
  if (target.measure) return *target.measure;
  if (target.pixels_per_unit > 0.0) return ScreenMeasure::constant(target.pixels_per_unit);
  return ScreenMeasure::filled_by(box, target.width, target.height);
}

// `points` in the world, which will have a track of so many controls.
Tessellation tessellated(const MeshMotion& motion, const MovingArray& points, const ScreenMeasure& measure,
                         std::uint32_t controls, const MeshTarget& target, PrimLog& log) {
  const EdgeLength edges{target.edge_length_pixels, measure, motion.displacements.reach()};
  return tessellated(motion.input, motion.polygons, points, edges, controls, *target.refinements, log);
}

// Of what is drawn as `drawn`, in the space that `measure` knows; a round one is drawn as what it is.
std::optional<double> shape_error(const MeshMotion& motion, const MovingArray& points,
                                  const Tessellation* drawn, bool displaced, const ScreenMeasure& measure,
                                  const MeshTarget& target) {
  if (!target.measure_shape) return std::nullopt;
  if (!drawn) return 0.0;
  if (displaced) {
    if (!drawn->refinement()) return std::nullopt;
    const double pixels = displaced_stray(motion.input, motion.displacements, *drawn, points, measure);
    return std::isfinite(pixels) ? std::optional(pixels) : std::nullopt;
  }
  // A size that nobody knows yet: its instances say it.
  if (motion.input.stray > 0.0 && !target.measure && !(target.pixels_per_unit > 0.0)) return std::nullopt;
  const std::optional<double> found = stray_pixels(motion.input, *drawn, points, measure);
  return found && std::isfinite(*found) ? found : std::nullopt;
}

// Warns where not even the best track was within its tolerance.
void report_track(const TrackReport& track, FitSettings settings, const char* attribute, PrimLog& log) {
  settings.tolerance = track.tolerance_pixels;
  report_fit({track.segments, track.error_pixels}, settings, attribute, "the motion", log);
}

// What is placed by the transform's own track.
void set_moving(const MeshInput& input, const InstanceChain& chain, const TransformFitter& fitter,
                const Judgement& judgement, TranslatedMesh& result) {
  const TransformFitter::Verdict& verdict = judgement.verdict;
  const TrackForm form = fitter.form(verdict.track);
  result.track = {input.path, "transform", chain.rule()};
  result.track.set_form(form, fitter.time_remap(verdict.track));
  result.track.moving_transform = true;
  result.track.error_pixels = verdict.error;
  result.track.tolerance_pixels = judgement.tolerance;
  result.track.error_outside = judgement.outside;
  result.track.outside = judgement.outside;
  result.track.coarser = judgement.keys_saved > 0;
  result.track.keys_saved = judgement.keys_saved;
  result.track.bytes = form.controls() * sizeof(Affine3f);
  result.world_from_mesh.resize(form.controls());
  fitter.controls(0, verdict.track, result.world_from_mesh.data());
  set_time_remap(input, fitter.time_remap(verdict.track), result);
}

std::optional<TranslatedMesh> in_moving_transform(const MeshMotion& motion, MeshTarget& target,
                                                  PrimLog& log) {
  const auto& [input, points, transform, polygons, displacements, round] = motion;
  const Vec3d shift = exact_origin(bounds({points.track, TransformTrack(Affine3d{})}));
  const MovingArray still{points.track, TransformTrack(rebased(Affine3d{}, {}, shift))};
  const Box3d own = bounds(still);
  if (!check_range(own, log) || !check_range(bounds(own, transform.rebased(shift, *target.origin)), log)) {
    return std::nullopt;
  }
  const Box3d box = grown(own, round ? round->reach() : displacements.reach());
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
  const auto place = [&](TranslatedMesh& result) {
    const Box3d drawn = target.outside ? result.box() : box;
    const OutsideJudge judge(fitter, target.settings, drawn, target.outside);
    set_moving(input, *chain, fitter, judge.judge(0, verdict), result);
    report_track(result.track, target.settings, kTransform, log);
  };

  const MovingArray moving{points.track, transform.rebased({}, *target.origin)};
  TranslatedMesh result;
  const TimeLayout unmoved = TimeLayout::even(0);
  if (round) {
    if (!add_round(motion, still, {unmoved, 1}, target, result, log)) return std::nullopt;
    place(result);
    result.track.shape_error_pixels = shape_error(motion, moving, nullptr, false, *target.measure, target);
    return result;
  }
  Tessellation topology = tessellated(motion, moving, *target.measure, 1, target, log);
  if (topology.triangles().empty()) return std::nullopt;
  auto displaced =
      displaced_shape(input, displacements, still, topology, *target.measure, target.settings, log);
  Shape shape = displaced ? std::move(displaced->shape) : shape_of(still, {unmoved, 1}, topology, input.path);
  add_shape(input, topology, {still.transform, unmoved, points.frame_only}, target, std::move(shape), result,
            log);
  place(result);
  result.track.shape_error_pixels =
      shape_error(motion, moving, &topology, displaced.has_value(), *target.measure, target);
  return result;
}

std::string rule_of(const PointMotion& points, const TransformTrack& transform) {
  const char* moved = "the transform by the stage's own evaluation";
  if (transform.is_still()) return points.rule;
  return points.track.is_still() ? moved : message(points.rule, "; ", moved);
}

std::size_t bytes_of(const TranslatedMesh& geometry) {
  if (geometry.grids) return geometry.grids->shape.values.size() * sizeof(float);
  if (geometry.curves) return geometry.curves->shape.vertices.size() * sizeof(RoundVertex);
  if (geometry.points) return geometry.points->shape.vertices.size() * sizeof(RoundVertex);
  return geometry.mesh.shape.position_count() * sizeof(Vec3f);
}

// What carries its motion itself.
void set_baked(const MeshMotion& motion, const PointFit& fit, double tolerance, TranslatedMesh& result) {
  const auto& [input, points, transform, polygons, displacements, round] = motion;
  const bool by_transform = points.track.is_still() && !transform.is_still();
  result.track = {input.path, by_transform ? "transform" : points.source, rule_of(points, transform)};
  result.track.set_form(fit.track.form(), fit.track.layout.time_remap());
  result.track.error_pixels = fit.error;
  result.track.tolerance_pixels = tolerance;
  result.track.bytes = bytes_of(result);
  set_time_remap(input, fit.track.layout.time_remap(), result);
}

std::optional<TranslatedMesh> baked(const MeshMotion& motion, const FitSettings& settings, MeshTarget& target,
                                    PrimLog& log) {
  const auto& [input, points, transform, polygons, displacements, round] = motion;
  if (!target.origin) target.origin = exact_origin(bounds({points.track, transform}));
  const MovingArray moving{points.track, transform.rebased({}, *target.origin)};
  const Box3d box = bounds(moving);
  if (!check_range(box, log)) return std::nullopt;
  const ScreenMeasure measure = measure_of(target, box);
  PointFit fit = fit_points(moving, measure, settings);
  if (round) {
    fit = with_own_keys(std::move(fit), motion, moving, box, measure, settings);
    report_fit({fit.track.form().segments, fit.error}, settings, kPoints, "the motion", log);
    TranslatedMesh result;
    if (!add_round(motion, moving, fit.track, target, result, log)) return std::nullopt;
    set_baked(motion, fit, settings.tolerance, result);
    result.track.shape_error_pixels = shape_error(motion, moving, nullptr, false, measure, target);
    return result;
  }
  Tessellation topology = tessellated(motion, moving, measure, fit.track.form().controls(), target, log);
  if (topology.triangles().empty()) return std::nullopt;  // a boundary rule may leave no face a surface
  auto displaced = displaced_shape(input, displacements, moving, topology, measure, settings, log);
  if (displaced) fit = std::move(displaced->fit);
  const TrackForm form = fit.track.form();
  report_fit({form.segments, fit.error}, settings, kPoints, "the motion", log);

  TranslatedMesh result;
  Shape shape = displaced ? std::move(displaced->shape) : shape_of(moving, fit.track, topology, input.path);
  if (!check_controls(shape.mesh, log)) return std::nullopt;
  add_shape(input, topology, {moving.transform, fit.track.layout, points.frame_only}, target,
            std::move(shape), result, log);
  set_baked(motion, fit, settings.tolerance, result);
  result.track.shape_error_pixels =
      shape_error(motion, moving, &topology, displaced.has_value(), measure, target);
  return result;
}

void set_outside(double tolerance, std::uint32_t keys_saved, TrackReport& track) {
  track.outside = 1;
  track.error_outside = true;
  track.tolerance_pixels = tolerance;
  track.coarser = keys_saved > 0;
  track.keys_saved = keys_saved;
}

void set_inside(double tolerance, TrackReport& track) {
  set_outside(tolerance, 0, track);
  track.outside = 0;
  track.error_outside = false;
}

// Within the motion tolerance or, of what lies outside of the picture by either track, within the coarser
// one: the rule of OutsideJudge, for what carries its motion itself.
std::optional<TranslatedMesh> baked_as_seen(const MeshMotion& motion, MeshTarget& target, PrimLog& log) {
  const Outside* outside = target.outside;
  const double fine_tolerance = target.settings.tolerance;
  const std::size_t start = log.said();
  const std::uint64_t bytes_left = *target.triangle_bytes_left;
  std::optional<TranslatedMesh> fine = baked(motion, target.settings, target, log);
  if (!fine || !outside || fine->track.segments == 0 || !outside->view.misses(fine->box())) return fine;

  FitSettings settings = target.settings;
  settings.tolerance = outside->tolerance(target.settings);
  const std::uint32_t fine_keys = fine->track.controls();
  const double fine_error = fine->track.error_pixels;
  set_outside(settings.tolerance, 0, fine->track);
  if (!may_be_coarser(fine_keys, fine_error, fine_tolerance)) return fine;

  const std::size_t middle = log.said();
  // Neither its form nor what is left to other shapes depends on which track is taken.
  const std::uint64_t fine_bytes_left = *target.triangle_bytes_left;
  *target.triangle_bytes_left = fine_bytes_left < bytes_left ? bytes_left : 0;
  PrimLog again = log;
  std::optional<TranslatedMesh> coarse = baked(motion, settings, target, again);
  *target.triangle_bytes_left = fine_bytes_left;
  const bool stays_outside = coarse && outside->view.misses(coarse->box());
  if (stays_outside && is_worth_it(coarse->track.controls(), fine_keys, fine_error, fine_tolerance)) {
    const std::uint32_t keys = coarse->track.controls();
    set_outside(settings.tolerance, keys < fine_keys ? fine_keys - keys : 0, coarse->track);
    log.take_back(start, middle);
    return coarse;
  }
  if (!stays_outside) set_inside(fine_tolerance, fine->track);
  log.take_back(middle, log.said());
  return fine;
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
  if (!points) return std::nullopt;
  std::optional<RoundShape> round;
  Triangulation polygons;
  if (is_round(input)) {
    round = RoundShape::make(input, points->track.size(), points->frame_only, target.curves,
                             target.settings.max_segments, log);
    if (!round) return std::nullopt;
  } else {
    if (!check_topology(input, points->track.size(), log)) return std::nullopt;
    polygons = triangulate(input, points->track.size(), log);
    if (polygons.triangles.empty()) return std::nullopt;
  }
  const TransformTrack transform(input.world_from_object);
  const bool in_world = target.measure != nullptr;
  const FaceDisplacements displacements(input, target.displacements, log);
  const MeshMotion motion{input, *points, transform, polygons, displacements, round ? &*round : nullptr};
  const bool still = points->track.is_still() && displacements.is_still() && (!round || round->is_still());
  const bool keeps_transform =
      in_world && still && !transform.is_still() && !transform.is_singular_somewhere();
  return keeps_transform ? in_moving_transform(motion, target, log) : baked_as_seen(motion, target, log);
}

const std::string& TranslatedMesh::name() const {
  return grids    ? grids->shape.name
         : curves ? curves->shape.name
         : points ? points->shape.name
                  : mesh.shape.name;
}

Appearance& TranslatedMesh::look() {
  if (grids) return *grids;
  if (curves) return *curves;
  if (points) return *points;
  return mesh;
}

Box3d TranslatedMesh::box() const {
  if (grids) return drawn_box(grids->shape);
  if (curves) return drawn_box(curves->shape.vertices);
  if (points) return drawn_box(points->shape.vertices);
  return drawn_box(mesh.shape);
}

}  // namespace msbvh::translate
