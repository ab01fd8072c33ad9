// Tracers under test: ours loses no ray, and those that a broken one loses are counted.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/probe/closed_mesh.h"
#include "core/probe/inside_rays.h"
#include "core/probe/tracer_under_test.h"
#include "core/trace/oracle.h"

using namespace msbvh;

namespace {

// Ours, but that it loses the rays of some times, or sees the surface a hundredth too far away.
class Broken : public TracerUnderTest {
 public:
  enum class Defect { kLosesLateRays, kTooFar };
  Broken(const Bvh& world, Defect defect)
      : ours_(world, supported_instruction_sets().back()), defect_(defect) {}
  static bool is_late(const Ray& ray) { return ray.time > 0.75f; }

  const std::vector<std::string>& ways() const override { return ours_.ways(); }
  void closest(std::size_t way, std::span<const Ray> rays, float* t) const override {
    ours_.closest(way, rays, t);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (defect_ == Defect::kTooFar) t[i] *= 1.01f;
      if (defect_ == Defect::kLosesLateRays && is_late(rays[i]))
        t[i] = std::numeric_limits<float>::infinity();
    }
  }

 private:
  const OurTracerUnderTest ours_;
  const Defect defect_;
};

struct Ball {
  Ball() {
    accel.add_mesh(std::make_shared<const TriangleMesh>(
        validated(procedural::moved(procedural::sphere(8), 16, procedural::rotation({0, 1, 0}, 2.0)))));
    accel.commit();
    shown = std::make_unique<ShownMeshes>(accel.bvh());
    inside = inside_rays(*shown, closed_meshes(*shown), 50, 3000, 1);
  }
  Accel accel;
  std::unique_ptr<ShownMeshes> shown;
  InsideRays inside;
};

}  // namespace

TEST_CASE("no way of asking ours loses a ray, and all of them answer alike") {
  const Ball ball;
  REQUIRE(ball.inside.rays.size() == 3000);
  for (const InstructionSet set : supported_instruction_sets()) {
    const OurTracerUnderTest ours(ball.accel.bvh(), set);
    REQUIRE(ours.ways().size() == 4);
    std::vector<std::vector<float>> t(4, std::vector<float>(ball.inside.rays.size()));
    for (std::size_t way = 0; way < 4; ++way) {
      CHECK(lost_rays(ours, way, ball.inside.rays).empty());
      ours.closest(way, ball.inside.rays, t[way].data());
    }
    CHECK(t[0] == t[1]);
    CHECK(t[2] == t[3]);
  }
}

TEST_CASE("rays that a broken tracer loses are counted, each of them and no others") {
  const Ball ball;
  const Broken broken(ball.accel.bvh(), Broken::Defect::kLosesLateRays);
  std::vector<std::size_t> late;
  for (std::size_t i = 0; i < ball.inside.rays.size(); ++i) {
    if (Broken::is_late(ball.inside.rays[i])) late.push_back(i);
  }
  REQUIRE(late.size() > 100);
  REQUIRE(late.size() < ball.inside.rays.size());
  for (std::size_t way = 0; way < broken.ways().size(); ++way)
    CHECK(lost_rays(broken, way, ball.inside.rays) == late);
}

TEST_CASE("a distance is judged by itself: ours is right, a miss and a wrong distance are not") {
  const Ball ball;
  const Bvh& world = ball.accel.bvh();
  const OurTracerUnderTest ours(world, supported_instruction_sets().back());
  const Broken far(world, Broken::Defect::kTooFar);
  std::size_t wrong = 0, wrong_far = 0, missed = 0;
  for (std::size_t i = 0; i < ball.inside.rays.size(); ++i) {
    const Ray& ray = ball.inside.rays[i];
    if (ball.inside.aims[i] == InsideAim::kFromSurface) continue;  // many of them hit at t = 0
    float t = 0.0f;
    ours.closest(0, {&ray, 1}, &t);
    wrong += judge_distance(world, ray, t).has_value();
    far.closest(0, {&ray, 1}, &t);
    wrong_far += judge_distance(world, ray, t).has_value();
    missed += judge_distance(world, ray, std::numeric_limits<float>::infinity()).has_value();
  }
  CHECK(wrong == 0);
  CHECK(wrong_far > 2400);  // along a face there may be another answer a hundredth farther away
  CHECK(missed > 1400);     // at edges and vertices no triangle is hit clearly
}

TEST_CASE("inside rays of a seed are the same, and all meshes have some") {
  const Ball ball;
  const InsideRays again = inside_rays(*ball.shown, closed_meshes(*ball.shown), 50, 3000, 1);
  REQUIRE(again.rays.size() == ball.inside.rays.size());
  bool same = true;
  for (std::size_t i = 0; i < again.rays.size(); ++i)
    same &= again.rays[i].org == ball.inside.rays[i].org && again.rays[i].time == ball.inside.rays[i].time;
  CHECK(same);
  for (const InsideAim aim : kInsideAims) CHECK(std::ranges::count(again.aims, aim) == 500);
}

TEST_CASE("plain rays go in any direction at any time") {
  const Ball ball;
  const InsideRays plain =
      inside_rays(*ball.shown, closed_meshes(*ball.shown), 50, 3000, 1, InsideMix::kPlain);
  REQUIRE(plain.rays.size() == 3000);
  CHECK(std::ranges::count(plain.aims, InsideAim::kAnywhere) == 3000);
  const auto at_key = [](const Ray& ray) { return ray.time * 128.0f == std::round(ray.time * 128.0f); };
  CHECK(std::ranges::count_if(ball.inside.rays, at_key) > 500);
  CHECK(std::ranges::count_if(plain.rays, at_key) == 0);
  for (std::size_t way = 0; way < 4; ++way) {
    const OurTracerUnderTest ours(ball.accel.bvh(), supported_instruction_sets().back());
    CHECK(lost_rays(ours, way, plain.rays).empty());
  }
}
