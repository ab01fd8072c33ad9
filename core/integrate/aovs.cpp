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
  return source.instances ? static_cast<std::int32_t>(source.instance) : -1;
}

std::int32_t prim_of(const Scene& scene, const Mesh& mesh) {
  return static_cast<std::int32_t>(mesh.prim_id == kNone ? &mesh - scene.meshes.data() : mesh.prim_id);
}

}  // namespace

AovSample aov_sample(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time) {
  const HitSource source = frame.index.resolve(hit);
  const Camera& camera = frame.scene().camera;
  const Mesh& mesh = *source.mesh;
  AovSample sample;
  sample.camera_depth = hit.t;
  sample.depth = window_depth(camera.projection, clip_range(camera, time), hit.t);
  sample.prim = prim_of(frame.scene(), mesh);
  sample.instance = instance_of(source);
  sample.element = static_cast<std::int32_t>(mesh.triangle_faces.empty() ? hit.triangle
                                                                         : mesh.triangle_faces[hit.triangle]);
  sample.normal = surface.shading_normal;
  sample.eye_normal = normal_in_camera(camera, time, surface.shading_normal);
  sample.albedo = surface.albedo;
  return sample;
}

void record_aovs(const Frame& frame, PathBatch& batch) {
  batch.aovs.assign(batch.slot.size(), {});
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    if (!batch.hits[place].found()) continue;
    batch.aovs[batch.active[place]] =
        aov_sample(frame, batch.hits[place], batch.surfaces[place], batch.rays[place].time);
  }
}

}  // namespace msbvh
