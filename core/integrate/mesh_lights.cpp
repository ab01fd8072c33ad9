#include "core/integrate/mesh_lights.h"

#include "core/integrate/covers.h"
#include "core/integrate/light_parts.h"
#include "core/integrate/mis.h"
#include "core/integrate/opacity.h"

namespace msbvh {
namespace {

// Rays under way; batch.retraced and batch.retraced_rays beside it.
class MetMeshes {
 public:
  MetMeshes(const Frame& frame, PathBatch& batch, bool transparent, bool specular)
      : frame_(frame), batch_(batch), transparent_(transparent), specular_(specular) {}

  void trace() {
    start();
    const bool splits_light = specular_ && batch_.depth == 0 && !batch_.light.empty();
    while (!batch_.retraced.empty()) {
      batch_.retraced_hits.resize(batch_.retraced.size());
      batch_.mark.trace(true);
      frame_.tracer.intersect(batch_.retraced_rays, batch_.retraced_hits.data(), batch_.traced);
      batch_.mark.trace(false);
      find_covers();
      step();
      if (splits_light) credit_specular(batch_, batch_.light_share);
    }
  }

 private:
  void start() {
    batch_.retraced.clear();
    batch_.retraced_rays.clear();
    for (const std::uint32_t place : batch_.shaded) {
      if (!(batch_.scatter_pdf[place] > 0.0f)) continue;
      batch_.retraced.push_back(place);
      batch_.retraced_rays.push_back(batch_.scattered[place]);
    }
    left_.assign(batch_.retraced.size(), 1.0f);
  }

  void find_covers() {
    batch_.found_covers.assign(batch_.retraced.size(), {});
    if (!transparent_) return;
    batch_.retraced_widths.clear();
    for (const std::uint32_t place : batch_.retraced)
      batch_.retraced_widths.push_back(frame_.textures ? batch_.widths[batch_.active[place]] : 0.0f);
    msbvh::find_covers(frame_, batch_.retraced_rays, batch_.retraced_hits, batch_.retraced_widths,
                       batch_.reads, batch_.by_material, batch_.found_covers);
  }

  // Past what the rays have met.
  void step() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch_.retraced.size(); ++i) {
      const Hit& hit = batch_.retraced_hits[i];
      if (!hit.found()) continue;
      const std::uint32_t place = batch_.retraced[i];
      Ray ray = batch_.retraced_rays[i];
      add(place, ray, hit, left_[i]);
      const float left = left_[i] * (1.0f - shadow_share(batch_.found_covers[i]));
      if (!(left > 0.0f)) continue;
      step_past(hit, ray);
      batch_.retraced[kept] = place;
      batch_.retraced_rays[kept] = ray;
      left_[kept++] = left;
    }
    batch_.retraced.resize(kept);
    batch_.retraced_rays.resize(kept);
  }

  void add(std::uint32_t place, const Ray& ray, const Hit& hit, float left) const {
    const LightPick* light = frame_.lights.mesh_at(frame_.index.resolve(hit));
    if (!light || !light->mesh->is_met()) return;
    if (!holds_group(light->light->lit_groups, frame_.index.resolve(batch_.hits[place]).light_group()))
      return;
    const PathIndex path = batch_.active[place];
    const SurfaceHit& surface = batch_.surfaces[place];
    const LightValues values = light->still ? light->still->values : values_at(*light->light, ray.time);
    const Vec3f normal = batch_.special.empty() ? surface.shading_normal
                                                : lit_side(batch_.special[place], surface.shading_normal);
    const float expected = frame_.lights.expected(*light, surface.position, normal);
    const float pdf = batch_.scatter_pdf[place];
    const float weight = power_heuristic(pdf, expected * light->mesh->pdf(ray.dir, hit, ray.time)) * left;
    Vec3f throughput = batch_.throughput[path];
    if (specular_) {
      const Bsdf::Value reflected = value_at(place, ray.dir);
      const Vec3f specular = reflected.specular * values.specular;
      const Vec3f both = reflected.diffuse * values.diffuse + specular;
      throughput = throughput * both * (1.0f / pdf);
      if (batch_.depth == 0 && !batch_.light.empty())
        batch_.light_share[path] = specular_share(specular, both);
    } else {
      throughput = throughput * values.diffuse;
    }
    batch_.radiance[path] += throughput * values.radiance * weight;
  }

  Bsdf::Value value_at(std::uint32_t place, const Vec3f& direction) const {
    const Bsdf& bsdf = batch_.bsdfs[place];
    const Vec3f& normal = batch_.surfaces[place].shading_normal;
    return batch_.special.empty() ? bsdf.at(normal, direction)
                                  : value_of(batch_.special[place], bsdf, normal, direction);
  }

  const Frame& frame_;
  PathBatch& batch_;
  const bool transparent_, specular_;
  std::vector<float> left_;  // of each ray, behind what it has passed
};

}  // namespace

void add_met_meshes(const Frame& frame, PathBatch& batch, bool transparent, bool specular) {
  MetMeshes(frame, batch, transparent, specular).trace();
}

void hide_met_meshes(const Frame& frame, PathBatch& batch) {
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const Hit& hit = batch.hits[place];
    if (hit.found() && frame.lights.mesh_at(frame.index.resolve(hit))) batch.surfaces[place].emission = {};
  }
}

}  // namespace msbvh
