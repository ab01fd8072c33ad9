// NURBS patches: their basis against its own laws, and the polygons that patches become.
#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "delegate/translate/shape/grid_seams.h"
#include "delegate/translate/shape/nurbs_grid.h"

namespace msbvh::translate {
namespace {

// Knots that start and end at the first and the last control point.
std::vector<double> clamped(int count, int order) {
  std::vector<double> knots(std::size_t(order), 0.0);
  for (int i = 1; i <= count - order; ++i) knots.push_back(i);
  knots.insert(knots.end(), std::size_t(order), count - order + 1);
  return knots;
}

struct Sheet {
  int columns, rows, u_order, v_order;
  std::vector<double> u_knots = clamped(columns, u_order), v_knots = clamped(rows, v_order);

  NurbsPatch patch() const {
    std::vector<Diagnostic> said;
    PrimLog log(said, "/patch");
    const NurbsInput input{"/patch", {"u", columns, u_order, u_knots, {}}, {"v", rows, v_order, v_knots, {}}};
    std::optional<NurbsPatch> made = NurbsPatch::make(input, log);
    REQUIRE(made);
    CHECK(said.empty());
    return *made;
  }
};

std::vector<Vec3f> random_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(-1.0f, 1.0f);
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({anywhere(random), anywhere(random), anywhere(random)});
  return points;
}

// The basis functions of a random axis, with some knots repeated.
SplineAxis random_axis(int count, int order, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<double> knots{0.0};
  while (knots.size() < std::size_t(count + order))
    knots.push_back(knots.back() + (random() % 3 == 0 ? 0.0 : 0.1 + 0.01 * double(random() % 100)));
  std::vector<Diagnostic> said;
  PrimLog log(said, "/patch");
  std::optional<SplineAxis> axis = SplineAxis::make({"u", count, order, knots, {}}, log);
  REQUIRE(axis);
  return *axis;
}

TEST_CASE("basis functions add up to 1, are positive, and have the derivatives of their differences") {
  for (int order = 2; order <= 7; ++order) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const SplineAxis axis = random_axis(order + 5, order, seed);
      for (const SplineSpan& span : axis.spans()) {
        const double step = 1e-5 * (span.end - span.begin);
        for (const double share : {0.1, 0.5, 0.8}) {
          const double at = span.begin + share * (span.end - span.begin);
          const SplineAxis::Basis basis = axis.basis(span, at);
          const SplineAxis::Basis before = axis.basis(span, at - step), after = axis.basis(span, at + step);
          double sum = 0.0, slope = 0.0;
          for (std::size_t i = 0; i < basis.values.size(); ++i) {
            CHECK(basis.values[i] >= 0.0);
            sum += basis.values[i];
            slope += basis.derivatives[i];
            const double difference = (after.values[i] - before.values[i]) / (2.0 * step);
            CHECK(basis.derivatives[i] == doctest::Approx(difference).epsilon(1e-5).scale(1.0 / step * 1e-4));
          }
          CHECK(sum == doctest::Approx(1.0).epsilon(1e-14));
          CHECK(std::abs(slope) < 1e-9);
        }
      }
    }
  }
}

TEST_CASE("a spline whose control points lie evenly on a line is that line") {
  // Greville: at the mean of its knots each control point has its own place.
  const SplineAxis axis = random_axis(9, 4, 3);
  std::vector<double> places;
  std::mt19937 random(3);
  std::vector<double> knots{0.0};
  while (knots.size() < 13)
    knots.push_back(knots.back() + (random() % 3 == 0 ? 0.0 : 0.1 + 0.01 * double(random() % 100)));
  for (std::size_t i = 0; i < 9; ++i) places.push_back((knots[i + 1] + knots[i + 2] + knots[i + 3]) / 3.0);
  for (const SplineSpan& span : axis.spans()) {
    const double at = 0.3 * span.begin + 0.7 * span.end;
    const SplineAxis::Basis basis = axis.basis(span, at);
    double found = 0.0, slope = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      found += basis.values[i] * places[span.first_control + i];
      slope += basis.derivatives[i] * places[span.first_control + i];
    }
    CHECK(found == doctest::Approx(at).epsilon(1e-12));
    CHECK(slope == doctest::Approx(1.0).epsilon(1e-10));
  }
}

TEST_CASE("refined points are linear in the control points, weighted or not") {
  const NurbsPatch patch = Sheet{6, 5, 4, 3}.patch();
  const std::vector<Vec3f> a = random_points(30, 1), b = random_points(30, 2);
  std::vector<Vec3f> mean;
  for (std::size_t i = 0; i < 30; ++i) mean.push_back((a[i] + b[i]) * 0.5f);
  std::vector<double> weights;
  for (int i = 0; i < 30; ++i) weights.push_back(0.5 + 0.1 * i);
  const std::vector<std::span<const Vec3f>> poses{a, b, mean};
  const std::vector<double> unweighted;
  for (const std::vector<double>& used : {unweighted, weights}) {
    const NurbsGrid grid(patch, {{3, 2, 4}, {1, 5, 2}}, poses, used, false);
    const auto at = [&](const std::vector<Vec3f>& pose) { return grid.positions({&pose[0].x, 90}, used); };
    const std::vector<float> of_a = at(a), of_b = at(b), of_mean = at(mean);
    REQUIRE(of_a.size() == 3 * grid.point_count());
    for (std::size_t i = 0; i < of_a.size(); ++i)
      CHECK(of_mean[i] == doctest::Approx(0.5 * (of_a[i] + of_b[i])).epsilon(1e-6));
    CHECK(grid.counts().size() == 9 * 8);
    CHECK(grid.point_count() == 10 * 9);
  }
}

TEST_CASE("varying values are bilinear between knots, and uniform ones count spans without length") {
  Sheet sheet{5, 4, 2, 2};
  sheet.u_knots = {0, 0, 1, 1, 3, 4, 4};  // a span of no length
  const NurbsPatch patch = sheet.patch();
  CHECK(patch.u().segment_count() == 4);
  CHECK(patch.u().spans().size() == 3);
  const std::vector<Vec3f> points = random_points(20, 4);
  const std::vector<std::span<const Vec3f>> poses{points};
  const NurbsGrid grid(patch, {{1, 2, 1}, {1, 1, 1}}, poses, {}, true);
  const std::set<int> seen(grid.segments().begin(), grid.segments().end());
  CHECK(seen == std::set<int>{0, 2, 3, 4, 6, 7, 8, 10, 11});
  std::vector<float> values;  // at the crossings: their number along u
  for (int v = 0; v < 4; ++v) {
    for (int u = 0; u < 5; ++u) values.push_back(float(u));
  }
  const std::vector<float> found = grid.varying_values(values, 1);
  const std::set<float> places(found.begin(), found.end());
  CHECK(places == std::set<float>{0, 1, 2, 2.5, 3, 4});
}

TEST_CASE("a knot as often there as the order tears the surface, one less often may bend it") {
  Sheet sheet{6, 2, 3, 2};
  std::vector<Vec3f> points;
  for (const float y : {0.0f, 1.0f}) {
    for (const float x : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f})
      points.push_back({x, y, x > 2.5f ? 1.0f : 0.0f});
  }
  const std::vector<std::span<const Vec3f>> poses{points};
  sheet.u_knots = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  const NurbsGrid torn(sheet.patch(), {{1, 1}, {1}}, poses, {}, false);
  CHECK(torn.point_count() == 8);
  const std::vector<float> places = torn.positions({&points[0].x, 36}, {});
  std::set<float> x;
  for (std::size_t i = 0; i < places.size(); i += 3) x.insert(places[i]);
  CHECK(x == std::set<float>{0, 2, 3, 5});
  sheet.u_knots = {0, 0, 0, 1, 1, 2, 3, 3, 3};
  const NurbsGrid bent(sheet.patch(), {{1, 1, 1}, {1}}, poses, {}, false);
  CHECK(bent.point_count() == 10);  // one line twice
}

TEST_CASE("too many cells are halved until there are few enough, with one warning") {
  const NurbsPatch patch = Sheet{4, 4, 4, 4}.patch();
  std::vector<Vec3f> points;
  for (int i = 0; i < 16; ++i) points.push_back({float(i % 4) * 1000.0f, float(i / 4) * 1000.0f, 0.0f});
  const std::vector<std::span<const Vec3f>> poses{points};
  const std::vector<Matrix4d> identity{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
  std::vector<Diagnostic> said;
  PrimLog log(said, "/patch");
  const NurbsCells few = patch.cells(poses, {}, identity, PixelSize::uniform(1.0), 100.0, log);
  CHECK(few.u == std::vector<std::uint32_t>{30});
  CHECK(said.empty());
  const NurbsCells many = patch.cells(poses, {}, identity, PixelSize::uniform(1e-3), 0.5, log);
  CHECK(many.u == std::vector<std::uint32_t>{NurbsPatch::kMostSpanCells});
  CHECK(std::uint64_t(many.u[0]) * many.v[0] <= NurbsPatch::kMostCells);
}

}  // namespace
}  // namespace msbvh::translate
