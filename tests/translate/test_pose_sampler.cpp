// How densely skeletons' poses of a mesh are sampled (delegate/translate/sample), against closed forms.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "delegate/translate/sample/pose_sampler.h"
#include "delegate/translate/sample/sampler.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

using Times = std::vector<double>;
using Function = std::function<double(double)>;

constexpr double kPi = std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Matrix4d kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Matrix4d turned(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

// A joint that turns by an angle, a blend shape with a weight, and rest points that are moved along x. What
// is not set does not act.
class Functions : public PoseSource {
 public:
  Function angle{}, weight{}, rest{};
  std::vector<Vec3f> points{{2, 0, 0}};
  Times breaks01{};
  Turns most{};
  bool is_still = false, is_usable = true;
  mutable Times asked01{};
  mutable std::size_t calls = 0;

  bool still() const override { return is_still; }
  Times breakpoints01() const override { return breaks01; }
  Turns turns() const override { return most; }
  bool moves_rest() const override { return bool(rest); }
  bool evaluate(std::span<const double> times01, PoseValues& out) const override {
    ++calls;
    for (const double time01 : times01) {
      asked01.push_back(time01);
      if (angle) out.joints.push_back(turned(angle(time01)));
      if (weight) out.weights.push_back(float(weight(time01)));
    }
    if (rest) {
      out.rest = points;
      for (Vec3f& p : out.rest) p.x += float(rest(times01.front()));
    }
    return is_usable;
  }
};

const std::vector<int> kJoint{0};
const std::vector<float> kWeight{1.0f};
const std::vector<Vec3f> kOffset{{0, 1, 0}}, kAlongX{{1, 0, 0}};

SkinningInput mesh_of(const Functions& source) {
  SkinningInput mesh;
  mesh.path = "/mesh";
  mesh.points = source.points;
  if (source.angle) {
    mesh.joint_indices = kJoint;
    mesh.joint_weights = kWeight;
    mesh.constant_influences = true;
  }
  if (source.weight) mesh.sub_shapes = {{"/shape", kOffset, {}, {}}};
  return mesh;
}

// A place that scales.
class Place : public MotionSource {
 public:
  explicit Place(const Matrix4d& matrix = kIdentity) : matrix_(matrix) {}

  std::size_t count() const override { return 1; }
  bool still() const override { return true; }
  Times breakpoints01() const override { return {}; }
  Turns turns(std::uint32_t) const override { return {}; }
  void evaluate(std::span<const double>, std::span<const std::uint32_t>,
                std::span<Matrix4d> out) const override {
    std::ranges::fill(out, matrix_);
  }

 private:
  Matrix4d matrix_;
};

// At the tolerance of so many units.
std::optional<PoseSamples> sampled(PoseSampler& sampler, const Functions& source, double units,
                                   bool held = false) {
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, "/mesh");
  return sampler.sample(source, Place(), PixelSize::uniform(1.0), units / kSamplingShare, held, log);
}

PoseSamples sampled(const Functions& source, double units, bool held = false) {
  PoseSampler sampler(mesh_of(source));
  std::optional<PoseSamples> samples = sampled(sampler, source, units, held);
  REQUIRE(samples);
  REQUIRE(samples->poses.size() == samples->times01.size());
  return *samples;
}

// The coarsest level at which `stray(interval)` is within the limit.
std::size_t times_of(const Function& stray, double limit, int level = kCoarsestPoseLevel) {
  while (stray(std::ldexp(1.0, -level)) > limit) ++level;
  return (std::size_t(1) << level) + 1;
}

}  // namespace

TEST_CASE("a turning joint is posed until the chord follows the arc") {
  for (const double turns : {0.05, 0.2, 0.4}) {
    Functions source;
    source.angle = [turns](double u) { return 2.0 * kPi * turns * u; };
    const auto sagitta = [turns](double interval) { return 2.0 * (1.0 - std::cos(kPi * turns * interval)); };
    for (const double units : {0.1, 1e-2, 1e-3, 1e-4}) {
      CAPTURE(turns);
      CAPTURE(units);
      const PoseSamples found = sampled(source, units);
      CHECK(found.times01.size() == times_of(sagitta, units));
      CHECK(found.follows);
      CHECK_FALSE(found.held);
      for (std::size_t i = 0; i < found.times01.size(); ++i) {
        const double angle = source.angle(found.times01[i]);
        const Vec3f& point = found.poses[i].points->front();
        CHECK(point.x == doctest::Approx(2.0 * std::cos(angle)));
        CHECK(point.y == doctest::Approx(2.0 * std::sin(angle)));
        CHECK_FALSE(found.poses[i].normals);
      }
    }
  }
}

TEST_CASE("whole turns that even times do not show are posed at eight times each") {
  Functions source;
  source.angle = [](double u) { return 8.0 * kPi * u; };
  CHECK(sampled(source, 100.0).times01.size() == 1);  // why turns() is asked for
  source.most = uniform_turns(4.0);
  CHECK(sampled(source, 100.0).times01.size() == 33);
}

TEST_CASE("weights that run along a curve are posed until lines follow, straight ones are not") {
  Functions source;
  source.weight = [](double u) { return 4.0 * u * u; };
  for (const double units : {0.1, 1e-2, 1e-3}) {
    CHECK(sampled(source, units).times01.size() == times_of([](double h) { return h * h; }, units));
  }
  source.weight = [](double u) { return 4.0 * u; };
  CHECK(sampled(source, 1e-5).times01.size() == 5);
}

TEST_CASE("normals are posed until they follow within their own tolerance") {
  Functions source;
  source.points = {{0, 0, 0}};
  source.angle = [](double u) { return 2.0 * u * u; };
  SkinningInput mesh = mesh_of(source);
  mesh.normals = kAlongX;
  PoseSampler sampler(mesh);
  const std::optional<PoseSamples> found = sampled(sampler, source, 1.0);
  REQUIRE(found);
  // Between directions at u and u + h the line has the mean angle, which is h^2 / 2 from that of the middle.
  const auto stray = [](double h) { return 2.0 * std::sin(0.25 * h * h); };
  CHECK(found->times01.size() == times_of(stray, kPosedNormalTolerance));
  CHECK(found->poses.back().normals->front().x == doctest::Approx(std::cos(2.0)));
}

TEST_CASE("breakpoints are posed, so that a corner needs no more") {
  Functions source;
  source.breaks01 = {0.3};
  source.weight = [](double u) { return std::abs(u - 0.3); };
  CHECK(sampled(source, 1e-5).times01 == Times{0.0, 0.25, 0.3, 0.5, 0.75, 1.0});
}

TEST_CASE("what does not change is posed once") {
  Functions source;
  source.angle = [](double) { return 1.0; };
  CHECK(sampled(source, 1e-9).times01 == Times{0.0});
  CHECK(source.asked01.size() == 5);
  source.is_still = true;
  source.asked01.clear();
  CHECK(sampled(source, 1e-9).times01 == Times{0.0});
  CHECK(source.asked01 == Times{0.0});
}

TEST_CASE("poses that differ by rounding are one, those that differ by more are not") {
  Functions source;
  for (const double roundings : {2.0, 8.0}) {
    source.rest = [roundings](double u) {
      return u == 0.5 ? roundings * 2.0 * std::numeric_limits<float>::epsilon() : 0.0;
    };
    CHECK((sampled(source, 1.0).times01.size() == 1) == (roundings < 4.0));
  }
}

TEST_CASE("held poses stand at the breakpoints and are read in the middle of what holds") {
  Functions source;
  source.breaks01 = {0.25, 0.75};
  source.weight = [](double u) { return u < 0.25 ? 1.0 : u < 0.75 ? 2.0 : 3.0; };
  const PoseSamples found = sampled(source, 1e-5, true);
  CHECK(found.held);
  CHECK(found.times01 == Times{0.0, 0.25, 0.75});
  CHECK(source.asked01 == Times{0.125, 0.5, 0.875});
  Times heights;
  for (const Pose& pose : found.poses) heights.push_back(pose.points->front().y);
  CHECK(heights == Times{1.0, 2.0, 3.0});
  source.weight = [](double) { return 1.0; };
  CHECK(sampled(source, 1e-5, true).times01 == Times{0.0});
  CHECK_FALSE(sampled(source, 1e-5, true).held);
}

TEST_CASE("rest points that move are asked for time by time") {
  Functions source;
  source.rest = [](double u) { return u * u; };
  const PoseSamples found = sampled(source, 0.01);
  CHECK(found.times01.size() == times_of([](double h) { return 0.25 * h * h; }, 0.01));
  CHECK(source.calls == source.asked01.size());
  CHECK(found.poses.back().points->front().x == 3.0f);
}

TEST_CASE("each pose is made once, however often the mesh is sampled") {
  Functions source;
  source.angle = [](double u) { return u; };
  PoseSampler sampler(mesh_of(source));
  const std::optional<PoseSamples> coarse = sampled(sampler, source, 1e-2);
  const std::optional<PoseSamples> fine = sampled(sampler, source, 1e-4);
  REQUIRE(coarse);
  REQUIRE(fine);
  CHECK(fine->times01.size() > coarse->times01.size());
  CHECK(fine->poses.front().points == coarse->poses.front().points);
  CHECK(sampled(sampler, source, 1e-2)->times01 == coarse->times01);
  Times asked01 = source.asked01;
  std::ranges::sort(asked01);
  CHECK(std::ranges::adjacent_find(asked01) == asked01.end());
}

TEST_CASE("what no affordable number of poses follows says so") {
  Functions source;
  source.weight = [](double u) { return std::sin(1e6 * u); };
  const PoseSamples found = sampled(source, 1e-3);
  CHECK_FALSE(found.follows);
  CHECK(found.times01.size() == (std::size_t(1) << kFinestPoseLevel) + 1);
}

TEST_CASE("a mesh that cannot be skinned has no poses") {
  Functions unusable;
  unusable.angle = [](double u) { return u; };
  unusable.is_usable = false;
  PoseSampler sampler(mesh_of(unusable));
  CHECK_FALSE(sampled(sampler, unusable, 1.0));

  Functions source;
  source.angle = [](double u) { return u > 0.6 ? kNaN : u; };
  PoseSampler other(mesh_of(source));
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, "/mesh");
  CHECK_FALSE(other.sample(source, Place(), PixelSize::uniform(1.0), 1.0, false, log));
  REQUIRE(diagnostics.size() == 1);
  CHECK(diagnostics[0].severity == Severity::kError);
}

TEST_CASE("the tolerance is that of the largest stretch of the place, and of the nearest point") {
  const Box3d box{{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  const PixelSize uniform = PixelSize::uniform(0.01);
  const auto tolerance = [&](const Matrix4d& m) { return pose_tolerance(box, Place(m), uniform, 0.5); };
  const double whole = kSamplingShare * 0.5 * 0.01;
  CHECK(tolerance(kIdentity) == doctest::Approx(whole));
  CHECK(tolerance(turned(0.7)) == doctest::Approx(whole));
  CHECK(tolerance({2, 0, 0, 0, 0, -3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}) == doctest::Approx(whole / 3.0));
  CHECK(tolerance({1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}) ==
        doctest::Approx(whole / std::numbers::phi));  // of a unit shear
  CHECK(std::isnan(tolerance({kNaN, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})));
  CHECK(tolerance({}) == doctest::Approx(whole / 1e-30));

  const PixelSize perspective({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, true, 0.01, 0.1);
  const Matrix4d away{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, -10, 1};
  CHECK(pose_tolerance(box, Place(away), perspective, 0.5) == doctest::Approx(whole * 8.0 / 2.0));
  CHECK(pose_tolerance({}, Place(away), perspective, 0.5) == doctest::Approx(whole * 10.0 / 2.0));
}

TEST_CASE("the place is looked at wherever it turns to") {
  // A box two units off the axis, which passes the camera as the place turns.
  class Turning : public Place {
   public:
    bool still() const override { return false; }
    void evaluate(std::span<const double> times01, std::span<const std::uint32_t>,
                  std::span<Matrix4d> out) const override {
      for (std::size_t t = 0; t < times01.size(); ++t) out[t] = turned(kPi * times01[t]);
    }
  };
  const PixelSize pixel_size({{-10.0, 0.0, 0.0}, {-10.0, 0.0, 0.0}}, true, 0.01, 0.1);
  const Box3d point{{2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
  CHECK(pose_tolerance(point, Turning(), pixel_size, 1.0) == doctest::Approx(kSamplingShare * 0.01 * 8.0));
}
