// How many rays go in which way (TraceModes).
#include <doctest/doctest.h>
#include <memory>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/trace/tracer.h"

namespace msbvh {
namespace {

constexpr std::size_t kRays = 1000;

// A few pixels of a camera, and rays from anywhere to anywhere.
std::vector<Ray> coherent_rays() {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < kRays; ++i)
    rays.push_back({.org = {0, 0, 9}, .dir = {0.001f * float(i % 32), 0.001f * float(i / 32), -1}});
  return rays;
}
std::vector<Ray> random_rays() {
  procedural::Random random(5);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < kRays; ++i) rays.push_back(procedural::random_ray(random, {}, 3));
  return rays;
}

void check_counts(const Accel& accel, const std::vector<Ray>& rays, bool packets) {
  const Tracer tracer(accel.bvh());
  std::vector<Hit> hits(rays.size());
  const auto occluded = std::make_unique<bool[]>(rays.size());
  TraceModes modes;
  tracer.intersect(rays, hits.data(), modes);
  CHECK(modes.rays() == rays.size());
  CHECK((modes.packets > rays.size() / 2) == packets);
  tracer.occluded(rays, occluded.get(), modes);
  CHECK(modes.rays() == 2 * rays.size());
  CHECK(modes.single == 0);
}

TEST_CASE("coherent rays go in packets, others and those among instances interleaved") {
  const auto object = std::make_shared<Accel>();
  object->add_mesh(procedural::sphere(40));
  object->commit();
  check_counts(*object, coherent_rays(), true);
  check_counts(*object, random_rays(), false);
  Accel world;
  const std::vector<Affine3f> maps(2);
  world.add_instances(object, {.segments = 1, .degree = 1}, maps);
  world.commit();
  check_counts(world, coherent_rays(), false);
}

}  // namespace
}  // namespace msbvh
