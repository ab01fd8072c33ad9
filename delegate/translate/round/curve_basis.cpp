#include "delegate/translate/round/curve_basis.h"

#include <algorithm>
#include <array>
#include <span>

#include "delegate/translate/round/left_out.h"
#include "delegate/translate/round/nurbs_basis.h"

namespace msbvh::translate {
namespace {

enum class Basis : std::uint8_t { kLinear, kBezier, kBspline, kCatmullRom };
enum class Wrap : std::uint8_t { kNonperiodic, kPeriodic, kPinned };

std::optional<Basis> basis_from(const CurveTopology& topology) {
  if (topology.type == "linear") return Basis::kLinear;
  if (topology.type != "cubic") return std::nullopt;
  if (topology.basis == "bezier") return Basis::kBezier;
  if (topology.basis == "bspline") return Basis::kBspline;
  if (topology.basis == "catmullRom") return Basis::kCatmullRom;
  return std::nullopt;
}

std::optional<Wrap> wrap_from(const std::string& token) {
  if (token == "nonperiodic") return Wrap::kNonperiodic;
  if (token == "periodic") return Wrap::kPeriodic;
  if (token == "pinned") return Wrap::kPinned;
  return std::nullopt;
}

struct Kind {
  Basis basis;
  Wrap wrap;

  bool periodic() const { return wrap == Wrap::kPeriodic; }
  // Where the curve begins at its first vertex and ends at its last; what has ends there anyway is pinned.
  bool pinned() const { return wrap == Wrap::kPinned; }

  // 0: not a number of vertices that there may be.
  std::size_t spans(std::size_t n) const {
    switch (basis) {
      case Basis::kLinear:
        return n < 2 ? 0 : periodic() ? n : n - 1;
      case Basis::kBezier:
        if (periodic()) return n >= 3 && n % 3 == 0 ? n / 3 : 0;
        return n >= 4 && (n - 4) % 3 == 0 ? (n - 4) / 3 + 1 : 0;
      case Basis::kBspline:
      case Basis::kCatmullRom:
        if (periodic()) return n >= 3 ? n : 0;
        if (pinned()) return n >= 2 ? n - 1 : 0;
        return n >= 4 ? n - 3 : 0;
    }
    return 0;
  }
  std::size_t varying(std::size_t spans) const { return periodic() ? spans : spans + 1; }
};

// Of the four vertices that a span of the basis is made of.
using Matrix = std::array<std::array<double, 4>, 4>;  // [Bezier vertex][basis vertex]
constexpr Matrix kBezierOfBezier = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
constexpr Matrix kBezierOfBspline = {{{1.0 / 6, 4.0 / 6, 1.0 / 6, 0},
                                      {0, 2.0 / 3, 1.0 / 3, 0},
                                      {0, 1.0 / 3, 2.0 / 3, 0},
                                      {0, 1.0 / 6, 4.0 / 6, 1.0 / 6}}};
constexpr Matrix kBezierOfCatmullRom = {
    {{0, 1, 0, 0}, {-1.0 / 6, 1, 1.0 / 6, 0}, {0, 1.0 / 6, 1, -1.0 / 6}, {0, 0, 1, 0}}};
constexpr Matrix kBezierOfLine = {
    {{1, 0, 0, 0}, {2.0 / 3, 1.0 / 3, 0, 0}, {1.0 / 3, 2.0 / 3, 0, 0}, {0, 1, 0, 0}}};

const Matrix& matrix_of(Basis basis) {
  switch (basis) {
    case Basis::kLinear:
      return kBezierOfLine;
    case Basis::kBezier:
      return kBezierOfBezier;
    case Basis::kBspline:
      return kBezierOfBspline;
    case Basis::kCatmullRom:
      break;
  }
  return kBezierOfCatmullRom;
}

// One authored curve: where its values are, and its share of the chains.
class Chain {
 public:
  Chain(const Kind& kind, std::uint32_t curve, std::uint32_t first, std::size_t count, CurveBasis& out)
      : kind_(kind), curve_(curve), first_(first), count_(static_cast<std::int64_t>(count)), out_(out) {}

  // `first_varying`: of the curve's own.
  void add(std::size_t spans, std::uint32_t first_varying) const {
    if (kind_.periodic() && spans > 0) {
      const auto before = static_cast<std::uint32_t>(out_.spans.size());
      out_.loops.push_back({before, before + static_cast<std::uint32_t>(spans) - 1});
    }
    for (std::size_t s = 0; s < spans; ++s) {
      out_.add_span(curve_, s > 0);
      const std::uint32_t from = first_varying + static_cast<std::uint32_t>(s);
      const std::uint32_t to = first_varying + static_cast<std::uint32_t>((s + 1) % kind_.varying(spans));
      for (std::uint32_t v = s > 0 ? 1 : 0; v < 4; ++v) add_vertex(s, v, {from, to, v / 3.0});
    }
  }

 private:
  void add_vertex(std::size_t span, std::uint32_t v, const CurveBasis::Between& varying) const {
    std::vector<Term> terms;
    const auto& row = matrix_of(kind_.basis)[v];
    for (std::uint32_t i = 0; i < 4; ++i) {
      if (row[i] != 0.0) add_term(first_of(span) + i, row[i], terms);
    }
    out_.add_vertex(curve_, terms, varying);
  }

  // The place of a span's first vertex among the curve's; pinned curves begin one before them.
  std::int64_t first_of(std::size_t span) const {
    const auto s = static_cast<std::int64_t>(span);
    if (kind_.basis == Basis::kBezier) return 3 * s;
    const bool before = kind_.pinned() && kind_.basis != Basis::kLinear;
    return before ? s - 1 : s;
  }

  // Beyond the ends of a pinned curve lies the mirror image of the vertex inside.
  void add_term(std::int64_t place, double weight, std::vector<Term>& terms) const {
    if (kind_.periodic()) return add_share(place % count_, weight, terms);
    if (place < 0) {
      add_share(0, 2.0 * weight, terms);
      return add_share(1, -weight, terms);
    }
    if (place >= count_) {
      add_share(count_ - 1, 2.0 * weight, terms);
      return add_share(count_ - 2, -weight, terms);
    }
    add_share(place, weight, terms);
  }
  void add_share(std::int64_t place, double weight, std::vector<Term>& terms) const {
    const std::uint32_t index = first_ + static_cast<std::uint32_t>(place);
    for (Term& term : terms) {
      if (term.index != index) continue;
      term.weight += weight;
      return;
    }
    terms.push_back({index, weight});
  }

  const Kind& kind_;
  const std::uint32_t curve_, first_;
  const std::int64_t count_;
  CurveBasis& out_;
};

// Between two vertices: with an end's tangent as long as the parameter's whole way.
void add_hermite_span(std::uint32_t curve, std::uint32_t first, std::uint32_t points, bool continues,
                      std::uint32_t varying, CurveBasis& out) {
  const auto at = [&](std::uint32_t v) { return CurveBasis::Between{varying, varying + 1, v / 3.0}; };
  const std::uint32_t tip = first + points;
  out.add_span(curve, continues);
  if (!continues) out.add_vertex(curve, std::array{Term{first, 1.0}}, at(0));
  out.add_vertex(curve, std::array{Term{first, 2.0 / 3}, Term{tip, 1.0 / 3}}, at(1));
  out.add_vertex(curve, std::array{Term{first + 1, 4.0 / 3}, Term{tip + 1, -1.0 / 3}}, at(2));
  out.add_vertex(curve, std::array{Term{first + 1, 1.0}}, at(3));
}

void add_hermite(const CurveTopology& topology, std::uint32_t points, LeftOut& left_out, CurveBasis& out) {
  out.vertex_as_varying = true;
  std::uint32_t first = 0;
  for (std::uint32_t curve = 0; curve < out.curves; ++curve) {
    const auto count = static_cast<std::uint32_t>(topology.vertex_counts[curve]);
    if (count < 2) {
      left_out.add(curve, message("has ", count, " vertices, which no hermite curve has"));
    } else {
      for (std::uint32_t i = 0; i + 1 < count; ++i)
        add_hermite_span(curve, first + i, points, i > 0, first + i, out);
    }
    first += count;
  }
  out.authored_varying = points;
}

bool check_indices(const CurveTopology& topology, std::size_t points, PrimLog& log) {
  for (const int index : topology.indices) {
    if (index < 0 || std::size_t(index) >= points)
      return log.reject("curveIndices", message("found ", index, "; expected one of ", points, " points"));
  }
  return true;
}

// `points`: or the indices of some.
bool check_counts(const CurveTopology& topology, std::size_t points, PrimLog& log) {
  std::size_t sum = 0;
  for (const int count : topology.vertex_counts) {
    if (count < 0)
      return log.reject("curveVertexCounts", message("found ", count, "; expected none below 0"));
    sum += std::size_t(count);
  }
  if (sum == points) return true;
  return log.reject("curveVertexCounts",
                    message("they add up to ", sum, "; expected ", points, ", the number of ",
                            topology.indices.empty() ? "points" : "indices"));
}

void add_of_basis(const CurveTopology& topology, const Kind& kind, LeftOut& left_out, CurveBasis& out) {
  std::uint32_t first = 0;
  std::vector<bool> hidden(out.curves, false);
  for (const int curve : topology.hidden) {
    if (curve >= 0 && std::size_t(curve) < hidden.size()) hidden[std::size_t(curve)] = true;
  }
  for (std::uint32_t curve = 0; curve < out.curves; ++curve) {
    const auto count = static_cast<std::size_t>(topology.vertex_counts[curve]);
    const std::size_t spans = kind.spans(count);
    if (spans == 0) {
      left_out.add(curve, message("has ", count, " vertices, which no ", topology.wrap, " ",
                                  topology.type == "linear" ? "linear" : topology.basis, " curve has"));
    }
    if (!hidden[curve]) Chain(kind, curve, first, count, out).add(spans, std::uint32_t(out.authored_varying));
    if (spans > 0) out.authored_varying += kind.varying(spans);
    first += std::uint32_t(count);
  }
}

std::optional<Kind> kind_of(const CurveTopology& topology, PrimLog& log) {
  const std::optional<Basis> basis = basis_from(topology);
  const std::optional<Wrap> wrap = wrap_from(topology.wrap);
  if (basis && wrap) return Kind{*basis, *wrap};
  log.reject(
      wrap ? "basis" : "wrap",
      message(
          "found type \"", topology.type, "\", basis \"", topology.basis, "\", wrap \"", topology.wrap,
          "\"; expected linear or cubic; bezier, bspline or catmullRom; nonperiodic, periodic or pinned"));
  return std::nullopt;
}

}  // namespace

std::optional<CurveBasis> curve_basis(const CurveTopology& topology, std::size_t points, PrimLog& log) {
  const bool hermite = topology.type == "hermite", nurbs = topology.type == "nurbs";
  const std::size_t vertices = hermite ? points / 2 : points;
  std::optional<Kind> kind;
  if (!hermite && !nurbs && !(kind = kind_of(topology, log))) return std::nullopt;
  const std::size_t counted = topology.indices.empty() ? vertices : topology.indices.size();
  if (!check_counts(topology, counted, log) || !check_indices(topology, vertices, log)) return std::nullopt;
  CurveBasis result;
  result.first_term.push_back(0);
  result.curves = topology.vertex_counts.size();
  result.authored_vertices = vertices;
  LeftOut left_out;
  if (hermite) {
    add_hermite(topology, static_cast<std::uint32_t>(vertices), left_out, result);
  } else if (nurbs) {
    if (!add_nurbs(topology, left_out, result, log)) return std::nullopt;
  } else {
    add_of_basis(topology, *kind, left_out, result);
  }
  if (!topology.indices.empty()) {
    for (Term& term : result.terms) term.index = std::uint32_t(topology.indices[term.index]);
  }
  left_out.report(result.curves, log);
  return result;
}

void CurveBasis::add_span(std::uint32_t curve, bool continues) {
  spans.push_back(static_cast<std::uint32_t>(vertex_count()) - (continues ? 1 : 0));
  span_curves.push_back(curve);
}

void CurveBasis::add_vertex(std::uint32_t curve, std::span<const Term> mix, const Between& between) {
  terms.insert(terms.end(), mix.begin(), mix.end());
  first_term.push_back(static_cast<std::uint32_t>(terms.size()));
  varying.push_back(between);
  vertex_curves.push_back(curve);
}

}  // namespace msbvh::translate
