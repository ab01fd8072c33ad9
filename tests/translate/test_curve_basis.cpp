// Curves of every basis and wrap, against their own definitions evaluated in double precision.
#include <cmath>
#include <doctest/doctest.h>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/round/curve_basis.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

std::vector<Vec3d> random_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-1.0, 1.0);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({at(random), at(random), at(random)});
  return points;
}

// Four vertices of the basis, and u in [0, 1]: the definition.
Vec3d evaluated(const std::string& basis, const Vec3d (&p)[4], double u) {
  const double v = 1.0 - u;
  if (basis == "linear") return p[0] * v + p[1] * u;
  if (basis == "bezier")
    return p[0] * (v * v * v) + p[1] * (3 * v * v * u) + p[2] * (3 * v * u * u) + p[3] * (u * u * u);
  if (basis == "bspline") {
    return (p[0] * (v * v * v) + p[1] * (3 * u * u * u - 6 * u * u + 4) +
            p[2] * (-3 * u * u * u + 3 * u * u + 3 * u + 1) + p[3] * (u * u * u)) *
           (1.0 / 6);
  }
  return (p[0] * (-u * u * u + 2 * u * u - u) + p[1] * (3 * u * u * u - 5 * u * u + 2) +
          p[2] * (-3 * u * u * u + 4 * u * u + u) + p[3] * (u * u * u - u * u)) *
         0.5;
}

// The vertices of the authored curve with its phantoms, and how many it goes on by a span.
struct Authored {
  std::vector<Vec3d> points;
  std::size_t step, spans;
};
Authored authored(const std::string& basis, const std::string& wrap, const std::vector<Vec3d>& p) {
  Authored a{p, basis == "bezier" ? 3u : 1u, 0};
  const std::size_t n = p.size();
  const bool cubic_blend = basis == "bspline" || basis == "catmullRom";
  if (wrap == "periodic") {
    for (std::size_t i = 0; i < 4; ++i) a.points.push_back(p[i % n]);
    a.spans = n / a.step;
  } else if (wrap == "pinned" && cubic_blend) {
    a.points.insert(a.points.begin(), p[0] * 2.0 - p[1]);
    a.points.push_back(p[n - 1] * 2.0 - p[n - 2]);
    a.spans = n - 1;
  } else {
    a.spans = basis == "linear" ? n - 1 : basis == "bezier" ? (n - 4) / 3 + 1 : n - 3;
  }
  return a;
}

CurveTopology topology(const std::string& basis, const std::string& wrap, const std::vector<int>& counts) {
  return {basis == "linear" ? "linear" : "cubic", basis == "linear" ? "bezier" : basis, wrap, counts};
}

Vec3d bezier_vertex(const CurveBasis& basis, const std::vector<Vec3d>& points, std::size_t vertex) {
  Vec3d sum;
  for (const Term& term : basis.terms_of(vertex)) sum += points[term.index] * term.weight;
  return sum;
}

std::vector<Diagnostic> said(const CurveTopology& topology, std::size_t points, bool usable) {
  std::vector<Diagnostic> all;
  PrimLog log(all, "/curves");
  CHECK(curve_basis(topology, points, log).has_value() == usable);
  return all;
}

}  // namespace

TEST_CASE("every basis and wrap is what it is defined as, at every place") {
  for (const std::string basis : {"linear", "bezier", "bspline", "catmullRom"}) {
    for (const std::string wrap : {"nonperiodic", "periodic", "pinned"}) {
      CAPTURE(basis);
      CAPTURE(wrap);
      const bool closed_bezier = basis == "bezier" && wrap == "periodic";
      const std::vector<int> counts = closed_bezier ? std::vector{6, 3, 9} : std::vector{7, 4, 10};
      std::size_t total = 0;
      for (const int count : counts) total += std::size_t(count);
      const std::vector<Vec3d> points = random_points(total, 7);
      std::vector<Diagnostic> all;
      PrimLog log(all, "/curves");
      const auto found = curve_basis(topology(basis, wrap, counts), total, log);
      REQUIRE(found);
      CHECK(all.empty());
      std::size_t span = 0, first = 0;
      for (std::size_t c = 0; c < counts.size(); ++c) {
        const std::vector<Vec3d> own(points.begin() + std::ptrdiff_t(first),
                                     points.begin() + std::ptrdiff_t(first) + counts[c]);
        const Authored a = authored(basis, wrap, own);
        for (std::size_t s = 0; s < a.spans; ++s, ++span) {
          REQUIRE(span < found->spans.size());
          CHECK(found->span_curves[span] == c);
          Vec3d p[4], b[4];
          for (std::size_t i = 0; i < 4; ++i) p[i] = a.points[std::min(s * a.step + i, a.points.size() - 1)];
          for (std::size_t i = 0; i < 4; ++i) b[i] = bezier_vertex(*found, points, found->spans[span] + i);
          for (double u = 0.0; u <= 1.0; u += 0.125)
            CHECK(length(evaluated("bezier", b, u) - evaluated(basis, p, u)) < 1e-12);
        }
        first += std::size_t(counts[c]);
      }
      CHECK(span == found->spans.size());
    }
  }
}

TEST_CASE("spans that follow each other share a vertex, curves do not") {
  std::vector<Diagnostic> all;
  PrimLog log(all, "/curves");
  const std::vector<int> counts{5, 4};
  const auto found = curve_basis(topology("bspline", "nonperiodic", counts), 9, log);
  REQUIRE(found);
  CHECK(found->spans == std::vector<std::uint32_t>{0, 3, 7});
  CHECK(found->vertex_count() == 11);
}

TEST_CASE("varying values lie at the spans' ends, linear between them") {
  std::vector<Diagnostic> all;
  PrimLog log(all, "/curves");
  const std::vector<int> counts{5, 4};
  const auto open = curve_basis(topology("bspline", "nonperiodic", counts), 9, log);
  REQUIRE(open);
  CHECK(open->authored_varying == 3 + 2);
  const auto& last = open->varying[10];
  CHECK((last.from == 3 && last.to == 4 && last.w == 1.0));
  const auto& inside = open->varying[4];
  CHECK((inside.from == 1 && inside.to == 2 && inside.w == 1.0 / 3));
  const auto closed = curve_basis(topology("bspline", "periodic", counts), 9, log);
  REQUIRE(closed);
  CHECK(closed->authored_varying == 5 + 4);
  CHECK(closed->varying[15].to == 0);  // the first curve's end
}

TEST_CASE("curves of a number of vertices that there is not are left out with one message") {
  std::vector<Diagnostic> all;
  PrimLog log(all, "/curves");
  const std::vector<int> counts{3, 4, 5, 0, 7};
  const auto found = curve_basis(topology("bezier", "nonperiodic", counts), 19, log);
  REQUIRE(found);
  REQUIRE(all.size() == 1);
  CHECK(all[0].message ==
        "3 of 5 curves are not drawn: curve 0 has 3 vertices, which no nonperiodic bezier curve has");
  CHECK(found->span_curves == std::vector<std::uint32_t>{1, 4, 4});
  CHECK(bezier_vertex(*found, random_points(19, 3), found->spans[0]) == random_points(19, 3)[3]);
}

TEST_CASE("counts that do not fit, and tokens that there are not") {
  const std::vector<int> counts{4, 4}, negative{4, -4};
  CHECK(said(topology("bezier", "nonperiodic", counts), 9, false)[0].message ==
        "they add up to 8; expected 9, the number of points");
  CHECK(said(topology("bezier", "nonperiodic", negative), 0, false)[0].message ==
        "found -4; expected none below 0");
  CHECK(said({"cubic", "power", "nonperiodic", counts}, 8, false)[0].attribute == "basis");
  CHECK(said({"cubic", "bezier", "closed", counts}, 8, false)[0].attribute == "wrap");
  CHECK(said({"quintic", "bezier", "pinned", counts}, 8, false)[0].attribute == "basis");
}

TEST_CASE("vertices may be points by index, and curves hidden") {
  std::vector<Diagnostic> said;
  PrimLog log(said, "/curves");
  const std::vector<int> counts{2, 3}, indices{2, 0, 0, 1, 2}, hidden{0, 9};
  CurveTopology topology;
  topology.type = "linear";
  topology.vertex_counts = counts;
  topology.indices = indices;
  const std::optional<CurveBasis> both = curve_basis(topology, 3, log);
  REQUIRE(both);
  CHECK(both->authored_vertices == 3);
  REQUIRE(both->spans.size() == 3);
  const auto corner = [&](const CurveBasis& basis, std::size_t vertex) {
    std::uint32_t index = 99;
    for (const Term& term : basis.terms_of(vertex)) {
      if (term.weight == 1.0) index = term.index;
    }
    return index;
  };
  CHECK(corner(*both, 0) == 2);  // the first curve: from point 2
  CHECK(corner(*both, both->spans[1]) == 0);
  CHECK(corner(*both, both->spans[2]) == 1);
  topology.hidden = hidden;
  const std::optional<CurveBasis> one = curve_basis(topology, 3, log);
  REQUIRE(one);
  CHECK(one->span_curves == std::vector<std::uint32_t>{1, 1});
  CHECK(one->authored_varying == both->authored_varying);  // values of what is hidden are skipped
  CHECK(one->varying.front().from == 2);
  CHECK(said.empty());
  CHECK_FALSE(curve_basis(topology, 2, log));
  REQUIRE(said.size() == 1);
  CHECK(said[0].message == "found 2; expected one of 2 points");
  topology.vertex_counts = std::span(counts).first(1);
  CHECK_FALSE(curve_basis(topology, 3, log));
  REQUIRE(said.size() == 2);
  CHECK(said[1].message == "they add up to 2; expected 5, the number of indices");
}
