#include "core/integrate/aovs.h"

#include "core/shade/camera.h"

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
  return sample;
}

void record_aovs(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kAovs, 0);
  batch.aovs.assign(batch.slot.size(), {});
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    if (!batch.hits[place].found()) continue;
    batch.aovs[batch.active[place]] =
        aov_sample(frame, batch.hits[place], batch.surfaces[place], batch.rays[place].time);
  }
}

}  // namespace msbvh
