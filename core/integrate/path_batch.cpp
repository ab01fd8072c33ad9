#include "core/integrate/path_batch.h"

namespace msbvh {

void ShadowQueue::add(const Ray& ray, PathIndex p, const Vec3f& light) {
  rays.push_back(ray);
  path.push_back(p);
  contribution.push_back(light);
}

void ShadowQueue::set(std::size_t i, const Ray& ray, PathIndex p, const Vec3f& light) {
  rays[i] = ray;
  path[i] = p;
  contribution[i] = light;
}

void ShadowQueue::resize(std::size_t count) {
  rays.resize(count);
  path.resize(count);
  contribution.resize(count);
}

void PathBatch::reset(std::size_t paths) {
  sampler.resize(paths);
  slot.resize(paths);
  throughput.assign(paths, {1.0f, 1.0f, 1.0f});
  radiance.assign(paths, {});
  alpha.assign(paths, 0.0f);
  depth = 0;
  active.resize(paths);
  rays.resize(paths);
  hits.resize(paths);
  surfaces.resize(paths);
  shaded.clear();
  scattered.resize(paths);
  scatter_pdf.resize(paths);
  shadows.resize(0);
  rays_traced = 0;
}

}  // namespace msbvh
