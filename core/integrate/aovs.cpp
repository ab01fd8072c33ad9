#include "core/integrate/aovs.h"

#include <algorithm>
#include <array>

#include "core/shade/camera.h"
#include "core/shade/material/surface_values.h"
#include "core/shade/point_motion.h"

namespace msbvh {
namespace {

// OpenGL's window depth of a distance along -z.
float window_depth(Projection projection, const ClipRange& clip, float distance) {
  const double n = clip.near_clip, f = clip.far_clip, z = distance;
  if (projection == Projection::kOrthographic) return static_cast<float>((z - n) / (f - n));
  return static_cast<float>(f / (f - n) * (1.0 - n / z));
}

std::int32_t instance_of(const HitSource& source) {
  if (!source.instances) return -1;
  const std::vector<std::int32_t>& ids = source.instances->ids;
  return ids.empty() ? static_cast<std::int32_t>(source.instance) : ids[source.instance];
}

// Geometry without a prim's id counts on from kind to kind.
std::int32_t prim_of(const Scene& scene, const HitSource& source) {
  if (source.look->prim_id != kNone) return static_cast<std::int32_t>(source.look->prim_id);
  if (source.mesh) return static_cast<std::int32_t>(source.mesh - scene.meshes.data());
  std::size_t before = scene.meshes.size();
  if (source.grids) return static_cast<std::int32_t>(before + (source.grids - scene.grids.data()));
  before += scene.grids.size();
  if (source.curves) return static_cast<std::int32_t>(before + (source.curves - scene.curves.data()));
  before += scene.curves.size();
  return static_cast<std::int32_t>(before + (source.points - scene.points.data()));
}

// The face, curve or point.
std::int32_t element_of(const HitSource& source, std::uint32_t triangle) {
  if (source.grids) {
    const std::uint32_t grid = source.grids->shape.triangle(triangle).grid;
    const std::vector<std::uint32_t>& faces = source.grids->grid_faces;
    return static_cast<std::int32_t>(faces.empty() ? grid : faces[grid]);
  }
  const std::vector<std::uint32_t> none;
  const std::vector<std::uint32_t>& of = source.mesh     ? source.mesh->triangle_faces
                                         : source.curves ? source.curves->span_curves
                                                         : none;
  return static_cast<std::int32_t>(of.empty() ? triangle : of[triangle]);
}

// Of the instance's, else of the geometry's; 0 where neither has it.
std::array<float, 2> st_at(const Scene& scene, const HitSource& source, const Hit& hit, float time) {
  const auto name = std::ranges::find(scene.primvar_names, "st");
  if (name == scene.primvar_names.end()) return {};
  const auto st = static_cast<PrimvarName>(name - scene.primvar_names.begin());
  const Vec3f value = primvar_at(source, hit, st, time).value_or(Vec3f{});
  return {value.x, value.y};
}

std::array<float, 2> pixels(const ScreenPoint& p, double scale) {
  return {static_cast<float>(p.x * scale), static_cast<float>(p.y * scale)};
}

// Of one point of a surface, over the picture.
class ScreenPath {
 public:
  ScreenPath(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time)
      : frame_(frame), hit_(hit), source_(frame.index.resolve(hit)) {
    if (source_.curves || source_.points) offset_ = Vec3d(surface.position) - centre_of(source_, hit, time);
  }

  // Per unit of the shutter. False where the camera cannot see it.
  bool at(float time, Side side, Moving<ScreenPoint>& screen) const {
    const Moving<Vec3d> world = point_in_world(source_, hit_, offset_, time, side);
    return point_on_screen(frame_.scene().camera, world, time, side, frame_.width, frame_.height, screen);
  }

 private:
  const Frame& frame_;
  const Hit& hit_;
  HitSource source_;
  Vec3d offset_;
};

void record_motion(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time,
                   AovSample& sample) {
  const ScreenPath path(frame, hit, surface, time);
  const float at_frame = std::clamp(frame.frame_time.time01, 0.0f, 1.0f);
  Moving<ScreenPoint> before, after, open, close;
  if (!path.at(at_frame, Side::kBefore, before) || !path.at(at_frame, Side::kAfter, after)) return;
  const double frames = frame.frame_time.shutter_frames;
  if (frames > 0.0) {
    sample.forward = pixels(after.rate, 1.0 / frames);
    sample.backward = pixels(before.rate, -1.0 / frames);
  }
  if (!frame.aovs.has(Aov::kMotionCurve) || !path.at(0.0f, Side::kAfter, open) ||
      !path.at(1.0f, Side::kBefore, close))
    return;
  const ScreenPoint first = open.value - after.value, last = close.value - after.value;
  const ScreenPoint controls[] = {first, first - open.rate * (-1.0 / 3.0), last - close.rate * (1.0 / 3.0),
                                  last};
  for (std::size_t i = 0; i < 4; ++i) {
    sample.motion_curve[2 * i] = static_cast<float>(controls[i].x);
    sample.motion_curve[2 * i + 1] = static_cast<float>(controls[i].y);
  }
}

}  // namespace

AovSample aov_sample(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time) {
  const HitSource source = frame.index.resolve(hit);
  const Camera& camera = frame.scene().camera;
  AovSample sample;
  sample.camera_depth = hit.t;
  sample.depth = window_depth(camera.projection, clip_range(camera, time), hit.t);
  sample.prim = prim_of(frame.scene(), source);
  sample.instance = instance_of(source);
  sample.element = element_of(source, hit.triangle);
  sample.normal = surface.shading_normal;
  sample.eye_normal = normal_in_camera(camera, time, surface.shading_normal);
  sample.albedo = surface.albedo;
  const AovSet& asked = frame.aovs;
  if (asked.has(Aov::kPworld)) sample.position = Vec3f(Vec3d(surface.position) + frame.origin);
  if (asked.has(Aov::kPeye))
    sample.eye_position = Vec3f(point_in_camera(camera, Vec3d(surface.position), time));
  if (asked.has(Aov::kSt)) sample.st = st_at(frame.scene(), source, hit, time);
  if (asked.motion()) record_motion(frame, hit, surface, time, sample);
  return sample;
}

void begin_aovs(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kAovs, 0);
  const std::size_t paths = batch.slot.size();
  if (frame.aovs.light()) {
    batch.light.assign(paths, {});
    for (std::vector<Vec3f>* each : {&batch.specular, &batch.scattered_share, &batch.light_share,
                                     &batch.credited, &batch.sorted, &batch.sorted_specular})
      each->assign(paths, {});
  }
  if (!frame.aovs.cost()) return;
  batch.costs.resize(paths);
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    Hit hit;
    TraceCounts counts;
    frame.tracer.intersect_counted(batch.rays[place], hit, counts);
    batch.costs[batch.active[place]] = {double(counts.nodes), double(counts.primitives)};
  }
}

void record_aovs(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kAovs, 0);
  batch.aovs.assign(batch.slot.size(), {});
  if (frame.aovs.crypto()) batch.crypto.assign(batch.slot.size(), {});
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    if (!batch.hits[place].found()) continue;
    batch.aovs[batch.active[place]] =
        aov_sample(frame, batch.hits[place], batch.surfaces[place], batch.rays[place].time);
    if (!frame.aovs.crypto()) continue;
    const HitSource source = frame.index.resolve(batch.hits[place]);
    batch.crypto[batch.active[place]] =
        frame.crypto_names.of(source, material_index(source, batch.hits[place]));
  }
}

}  // namespace msbvh
