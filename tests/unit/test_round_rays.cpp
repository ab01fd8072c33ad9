// Rays into tubes and spheres: they end inside, ours stops all of them, and what thinner shapes let through
// is seen.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <doctest/doctest.h>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/api/accel.h"
#include "core/probe/round_rays.h"
#include "core/probe/tracer_under_test.h"

using namespace msbvh;

namespace {

constexpr float kRadius = 0.2f;

// Two spheres, the second of which crosses the first one's way.
PointSet spheres(float radius) {
  PointSet set;
  set.name = "spheres";
  set.segments = 1;
  set.point_count = 2;
  set.vertices = {{{-1, 0, 0}, radius}, {{0, 1, 0}, radius}, {{1, 0, 0}, radius}, {{0, -1, 0}, radius}};
  return set;
}
Vec3d centre(std::uint32_t point, double u) {
  const double along = 2.0 * u - 1.0;
  return point == 0 ? Vec3d{along, 0, 0} : Vec3d{0, -along, 0};
}

CurveSet tube(CurveShape shape, float radius) {
  CurveSet set;
  set.name = "tube";
  set.segments = 1;
  set.shape = shape;
  set.vertex_count = 4;
  for (const float height : {0.0f, 2.0f}) {
    for (const float x : {-1.0f, -0.3f, 0.3f, 1.0f}) set.vertices.push_back({{x, height + x * x, 0}, radius});
  }
  set.spans = {0};
  return set;
}

Accel accel_of(PointSet set) {
  Accel accel;
  accel.add_points(std::move(set));
  accel.commit();
  return accel;
}
Accel accel_of(CurveSet set) {
  Accel accel;
  accel.add_curves(std::move(set));
  accel.commit();
  return accel;
}

void check_stopped(const Accel& accel, std::span<const Ray> rays) {
  for (const InstructionSet set : supported_instruction_sets()) {
    const OurTracerUnderTest ours(accel.bvh(), set);
    for (std::size_t way = 0; way < ours.ways().size(); ++way) CHECK(lost_rays(ours, way, rays).empty());
  }
}

std::size_t lost_by(const Accel& accel, std::span<const Ray> rays) {
  return lost_rays(OurTracerUnderTest(accel.bvh(), supported_instruction_sets().back()), 0, rays).size();
}

}  // namespace

TEST_CASE("rays into spheres end inside of one, and start outside of all") {
  const Accel accel = accel_of(spheres(kRadius));
  const std::vector<Ray> rays = rays_into_round(accel.bvh(), 3000, 1);
  REQUIRE(rays.size() == 3000);
  for (const Ray& ray : rays) {
    double end = std::numeric_limits<double>::infinity(), start = end;
    for (std::uint32_t point = 0; point < 2; ++point) {
      const Vec3d c = centre(point, double(ray.time));
      end = std::min(end, length(Vec3d(ray.org) + Vec3d(ray.dir) - c));
      start = std::min(start, length(Vec3d(ray.org) - c));
    }
    CHECK(end < 0.501 * double(kRadius));
    CHECK(start > double(kRadius));
  }
  CHECK(rays[7].org == rays_into_round(accel.bvh(), 3000, 1)[7].org);
  check_stopped(accel, rays);
  CHECK(lost_by(accel_of(spheres(0.25f * kRadius)), rays) > 300);
}

TEST_CASE("rays into tubes are stopped, and go by thinner ones") {
  const Accel accel = accel_of(tube(CurveShape::kTube, kRadius));
  const std::vector<Ray> rays = rays_into_round(accel.bvh(), 3000, 1);
  REQUIRE(rays.size() > 2500);
  check_stopped(accel, rays);
  CHECK(lost_by(accel_of(tube(CurveShape::kTube, 0.25f * kRadius)), rays) > 300);
}

TEST_CASE("nothing is aimed at ribbons, at what is too thin for single precision, or at nothing") {
  CHECK(rays_into_round(accel_of(tube(CurveShape::kRibbon, kRadius)).bvh(), 100, 1).empty());
  CHECK(rays_into_round(accel_of(spheres(1e-6f)).bvh(), 100, 1).empty());
  Accel empty;
  empty.commit();
  CHECK(rays_into_round(empty.bvh(), 100, 1).empty());
}
