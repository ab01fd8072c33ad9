// Curves of every basis and NURBS, as they become cubic spans or polygons.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "delegate/translate/round/curve_basis.h"
#include "delegate/translate/shape/nurbs_grid.h"
#include "tests/fuzz/fuzzed_data.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;
using namespace msbvh::translate;

namespace {

constexpr std::uint64_t kMostCells = 5000;  // that are evaluated here

// Not decreasing, some of them repeated; broken(): anything.
std::vector<double> fuzzed_knots(FuzzedData& data, std::size_t count) {
  std::vector<double> knots;
  double at = data.rarely() ? data.real() : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    knots.push_back(at);
    if (!data.coin()) at += data.rarely() ? data.positive() : 0.1 + data.unit();
    if (data.wrong()) at = data.real();
  }
  return knots;
}

void require_said(const std::vector<Diagnostic>& said, bool made) {
  bool error = false;
  for (const Diagnostic& d : said) {
    require(!d.path.empty() && !d.attribute.empty() && !d.message.empty(),
            "a message that names no prim or no attribute");
    require(d.message.find('\n') == std::string::npos, "a message of several lines");
    error |= d.severity == Severity::kError;
  }
  require(made || error, "nothing was made, and no error says why");
}

void check_basis(const CurveBasis& basis, std::size_t points) {
  require(basis.first_term.size() == basis.vertex_count() + 1, "terms of another number of vertices");
  require(basis.first_term.back() == basis.terms.size(), "terms that belong to no vertex");
  for (const Term& term : basis.terms) {
    require(term.index < points, "a term of a point that there is not");
    require(std::isfinite(term.weight), "a share that is not finite");
  }
  require(basis.varying.size() == basis.vertex_count(), "varying values of another number of vertices");
  for (const CurveBasis::Between& between : basis.varying) {
    require(between.from < basis.authored_varying && between.to < basis.authored_varying,
            "a varying value that there is not");
    require(between.w >= 0.0 && between.w <= 1.0, "a share outside of [0, 1]");
  }
  require(basis.span_curves.size() == basis.spans.size(), "spans of no curve");
  for (const std::uint32_t span : basis.spans)
    require(span + 3 < basis.vertex_count(), "a span beyond the vertices");
  for (const std::uint32_t curve : basis.span_curves)
    require(curve < basis.curves, "a span of a curve that there is not");
  CurveSet set;
  set.name = "/curves";
  set.vertex_count = std::uint32_t(basis.vertex_count());
  set.spans = basis.spans;
  set.vertices.resize(basis.vertex_count());
  set.loops = basis.loops;
  validate(set);  // what is made passes the core's gate
}

void convert_curves(FuzzedData& data) {
  CurveTopology topology;
  topology.type = data.word({"cubic", "linear", "hermite", "nurbs"});
  topology.basis = data.word({"bezier", "bspline", "catmullRom"});
  topology.wrap = data.word({"nonperiodic", "periodic", "pinned"});
  const std::uint32_t curves = data.below(4);
  const std::vector<int> counts = data.ints(curves, 0, 14);
  std::size_t points = 0;
  for (const int count : counts) points += std::size_t(std::clamp(count, 0, 100));
  if (topology.type == "hermite") points *= 2;
  if (data.wrong()) points += data.below(3);
  topology.vertex_counts = counts;
  const std::vector<int> orders = data.ints(data.wrong() ? data.below(4) : curves, 2, 6);
  std::size_t knot_count = 0;
  for (std::size_t i = 0; i < orders.size() && i < counts.size(); ++i) {
    knot_count += std::size_t(std::clamp(counts[i], 0, 100)) + std::size_t(std::clamp(orders[i], 0, 100));
  }
  const std::vector<double> knots = fuzzed_knots(data, knot_count + (data.wrong() ? 1 : 0));
  std::vector<double> ranges, weights;
  if (data.coin()) {
    for (std::size_t i = 0; i < 2 * std::size_t(curves); ++i)
      ranges.push_back(data.unit() * 3.0 + double(i % 2));
  }
  if (data.coin()) {
    for (std::size_t i = 0; i < points; ++i) weights.push_back(data.rarely() ? data.real() : 1.0);
  }
  topology.orders = orders;
  topology.knots = knots;
  topology.ranges = ranges;
  topology.weights = weights;
  std::vector<Diagnostic> said;
  PrimLog log(said, "/curves");
  const auto basis = curve_basis(topology, points, log);
  require_said(said, basis.has_value());
  if (basis) check_basis(*basis, points);
}

struct Axis {
  SplineInput input;
  std::vector<double> knots;
};

Axis fuzzed_axis(FuzzedData& data, const char* name) {
  Axis axis{{name, int(1 + data.below(12)), int(1 + data.below(6)), {}, {}}, {}};
  if (data.wrong()) axis.input.vertex_count = data.one_of({0, -1, 2147483647, 65536});
  if (data.wrong()) axis.input.order = data.one_of({0, -1, 65, 2147483647});
  const std::int64_t count = std::int64_t(axis.input.vertex_count) + axis.input.order;
  axis.knots =
      fuzzed_knots(data, std::size_t(std::clamp<std::int64_t>(count + (data.wrong() ? 1 : 0), 0, 100)));
  if (data.rarely()) axis.input.range = {data.real(), data.real()};
  return axis;
}

std::uint64_t total(const std::vector<std::uint32_t>& cells) {
  std::uint64_t sum = 0;
  for (const std::uint32_t n : cells) sum += n;
  return sum;
}

void cut_patch(FuzzedData& data) {
  Axis u = fuzzed_axis(data, "u"), v = fuzzed_axis(data, "v");
  u.input.knots = u.knots;
  v.input.knots = v.knots;
  std::vector<Diagnostic> said;
  PrimLog log(said, "/patch");
  const auto patch = NurbsPatch::make({"/patch", u.input, v.input}, log);
  require_said(said, patch.has_value());
  if (!patch) return;
  const std::vector<Vec3f> points = data.points(patch->control_count());
  std::vector<double> weights;
  if (data.coin()) {
    for (std::size_t i = 0; i < patch->control_count(); ++i)
      weights.push_back(data.rarely() ? data.real() : 1.0);
  }
  if (!patch->check_weights(weights, log)) weights.clear();
  // What comes before: a coordinate that is not finite leaves out the prim.
  for (const Vec3f& p : points) {
    if (!is_finite(p)) return;
  }
  const std::span<const Vec3f> pose = points;
  const Matrix4d matrix = data.matrix();
  const NurbsCells cells =
      patch->cells(std::span(&pose, 1), weights, std::span(&matrix, 1), PixelSize::uniform(data.positive()),
                   data.coin() ? 0.0 : data.positive(), log);
  require(cells.u.size() == patch->u().spans().size() && cells.v.size() == patch->v().spans().size(),
          "spans without cells");
  require(total(cells.u) * total(cells.v) <= NurbsPatch::kMostCells, "more cells than there may be");
  if (total(cells.u) * total(cells.v) > kMostCells) return;
  const NurbsGrid grid(*patch, cells, std::span(&pose, 1), weights, data.coin());
  std::uint64_t corners = 0;
  for (const int count : grid.counts()) corners += std::uint64_t(count);
  require(corners == grid.indices().size(), "corners that belong to no face");
  for (const int index : grid.indices())
    require(index >= 0 && std::size_t(index) < grid.point_count(), "a corner at no point");
  const std::vector<float> values(&points.front().x, &points.front().x + 3 * points.size());
  require(grid.positions(values, weights).size() == 3 * grid.point_count(),
          "places of another number of points");
  require(grid.vertex_values(values, 3, weights).size() == 3 * grid.point_count(),
          "values of another number of points");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  if (data.coin()) {
    convert_curves(data);
  } else {
    cut_patch(data);
  }
  return 0;
}
