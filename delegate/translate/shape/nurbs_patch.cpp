#include "delegate/translate/shape/nurbs_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace msbvh::translate {
namespace {

// Of the curves that are measured: pieces of a span, and curves across it a span of the other direction.
constexpr int kPieces = 4, kCurves = 2;

// Parameters at the ends of equal pieces of each span, those between spans twice.
std::vector<SplineStencil> stencils(const SplineAxis& axis, int pieces) {
  std::vector<SplineStencil> result;
  for (const SplineSpan& span : axis.spans()) {
    for (int i = 0; i <= pieces; ++i) {
      const double w = double(i) / pieces;
      const double parameter = span.begin * (1.0 - w) + span.end * w;
      result.push_back({span.first_control, axis.basis(span, parameter).values});
    }
  }
  return result;
}

Vec3d moved(const Vec3d& p, const Matrix4d& m) {
  return {p.x * m[0] + p.y * m[4] + p.z * m[8] + m[12], p.x * m[1] + p.y * m[5] + p.z * m[9] + m[13],
          p.x * m[2] + p.y * m[6] + p.z * m[10] + m[14]};
}

// The longest in pixels of curves over each span, as if all of their pieces were as long as the longest:
// `points` [curve][span][kPieces + 1].
void measure(const std::vector<Vec3d>& points, const PixelSize& pixel_size, std::vector<double>& longest) {
  const std::size_t spans = longest.size(), stride = kPieces + 1;
  for (std::size_t at = 0; at < points.size(); at += stride) {
    Box3d box;
    double piece = 0.0;
    for (std::size_t i = 0; i < stride; ++i) {
      box.grow(points[at + i]);
      if (i > 0) piece = std::max(piece, length(points[at + i] - points[at + i - 1]));
    }
    double& of_span = longest[at / stride % spans];
    const double pixels = kPieces * piece / pixel_size.at_box(box);
    if (pixels > of_span) of_span = pixels;
  }
}

// [u][v] of [v][u].
std::vector<Vec3d> transposed(const std::vector<Vec3d>& points, std::size_t width) {
  std::vector<Vec3d> result;
  result.reserve(points.size());
  for (std::size_t i = 0; i < width; ++i) {
    for (std::size_t at = i; at < points.size(); at += width) result.push_back(points[at]);
  }
  return result;
}

std::vector<std::uint32_t> cells_of(const std::vector<double>& pixels, double edge_pixels) {
  std::vector<std::uint32_t> cells;
  for (const double length : pixels) {
    const double wanted = std::ceil(length / edge_pixels);
    cells.push_back(std::uint32_t(std::clamp(wanted, 1.0, double(NurbsPatch::kMostSpanCells))));
  }
  return cells;
}

std::uint64_t sum(const std::vector<std::uint32_t>& cells) {
  std::uint64_t total = 0;
  for (const std::uint32_t each : cells) total += each;
  return total;
}

// Halves the numbers until there are not too many, or are 1.
int lower(NurbsCells& cells) {
  int times = 0;
  const auto halve = [](std::uint32_t& each) { each = (each + 1) / 2; };
  while (sum(cells.u) * sum(cells.v) > NurbsPatch::kMostCells &&
         sum(cells.u) + sum(cells.v) > cells.u.size() + cells.v.size()) {
    std::ranges::for_each(cells.u, halve);
    std::ranges::for_each(cells.v, halve);
    ++times;
  }
  return times;
}

}  // namespace

std::vector<double> weighted_crossings(const NurbsPatch& patch, std::span<const SplineStencil> u,
                                       std::span<const SplineStencil> v, std::span<const float> values,
                                       std::size_t width, std::span<const double> weights) {
  const std::size_t columns = patch.u().vertex_count(), rows = patch.v().vertex_count();
  const std::size_t stride = width + 1;  // the weight last
  std::vector<double> along_u(u.size() * rows * stride, 0.0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < u.size(); ++i) {
      double* to = &along_u[(row * u.size() + i) * stride];
      for (std::size_t c = 0; c < u[i].weights.size(); ++c) {
        const std::size_t control = row * columns + u[i].first_control + c;
        const double weight = u[i].weights[c] * (weights.empty() ? 1.0 : weights[control]);
        for (std::size_t k = 0; k < width; ++k) to[k] += weight * double(values[control * width + k]);
        to[width] += weight;
      }
    }
  }
  std::vector<double> result(u.size() * v.size() * stride, 0.0);
  for (std::size_t j = 0; j < v.size(); ++j) {
    for (std::size_t i = 0; i < u.size(); ++i) {
      double* to = &result[(j * u.size() + i) * stride];
      for (std::size_t c = 0; c < v[j].weights.size(); ++c) {
        const double* from = &along_u[((v[j].first_control + c) * u.size() + i) * stride];
        for (std::size_t k = 0; k < stride; ++k) to[k] += v[j].weights[c] * from[k];
      }
    }
  }
  return result;
}

std::vector<double> crossings(const NurbsPatch& patch, std::span<const SplineStencil> u,
                              std::span<const SplineStencil> v, std::span<const float> values,
                              std::size_t width, std::span<const double> weights) {
  std::vector<double> result = weighted_crossings(patch, u, v, values, width, weights);
  double* to = result.data();
  for (const double* from = to; from < result.data() + result.size(); from += width + 1) {
    const double weight = from[width];
    for (std::size_t k = 0; k < width; ++k) *to++ = from[k] / weight;
  }
  result.resize(u.size() * v.size() * width);
  return result;
}

std::optional<NurbsPatch> NurbsPatch::make(const NurbsInput& input, PrimLog& log) {
  std::optional<SplineAxis> u = SplineAxis::make(input.u, log);
  if (!u) return std::nullopt;
  std::optional<SplineAxis> v = SplineAxis::make(input.v, log);
  if (!v) return std::nullopt;
  return NurbsPatch(std::move(*u), std::move(*v));
}

bool NurbsPatch::check_weights(std::span<const double> weights, PrimLog& log) const {
  if (weights.empty()) return true;
  if (weights.size() != control_count()) {
    return log.reject("pointWeights", message("found ", weights.size(), " weights; expected ",
                                              control_count(), ", one a point"));
  }
  const auto bad =
      std::ranges::find_if(weights, [](double weight) { return !(weight > 0.0) || !std::isfinite(weight); });
  if (bad == weights.end()) return true;
  return log.reject("pointWeights", message("weight ", bad - weights.begin(), " is ", *bad,
                                            "; expected finite numbers larger than 0"));
}

bool NurbsPatch::check_primvar(const std::string& interpolation, std::size_t value_count,
                               std::span<const int> indices, const std::string& attribute,
                               PrimLog& log) const {
  const std::size_t u = u_.segment_count(), v = v_.segment_count();
  std::size_t expected = 0;
  if (interpolation == "constant") {
    expected = 1;
  } else if (interpolation == "uniform") {
    expected = u * v;
  } else if (interpolation == "varying") {
    expected = (u + 1) * (v + 1);
  } else if (interpolation == "vertex") {
    expected = control_count();
  } else {
    return log.reject(attribute, message("found the interpolation \"", interpolation,
                                         "\" on a patch; expected constant, uniform, varying or vertex"));
  }
  const std::size_t found = indices.empty() ? value_count : indices.size();
  if (found != expected) {
    return log.reject(attribute, message("found ", found, indices.empty() ? " values" : " indices",
                                         "; expected ", expected, " for the interpolation ", interpolation));
  }
  const auto bad = std::ranges::find_if(
      indices, [&](int index) { return index < 0 || std::size_t(index) >= value_count; });
  if (bad == indices.end()) return true;
  return log.reject(attribute, message("index ", bad - indices.begin(), " is ", *bad, "; expected less than ",
                                       value_count, ", the number of values"));
}

NurbsCells NurbsPatch::cells(std::span<const std::span<const Vec3f>> poses, std::span<const double> weights,
                             std::span<const Matrix4d> matrices, const PixelSize& pixel_size,
                             double edge_pixels, PrimLog& log) const {
  const std::size_t u_spans = u_.spans().size(), v_spans = v_.spans().size();
  if (!(edge_pixels > 0.0)) {
    return {std::vector<std::uint32_t>(u_spans, u_.order() - 1),
            std::vector<std::uint32_t>(v_spans, v_.order() - 1)};
  }
  const std::vector<SplineStencil> u_fine = stencils(u_, kPieces), v_fine = stencils(v_, kPieces);
  const std::vector<SplineStencil> u_few = stencils(u_, kCurves), v_few = stencils(v_, kCurves);
  std::vector<double> u_longest(u_spans, 0.0), v_longest(v_spans, 0.0);
  const auto look = [&](std::span<const Vec3f> pose, const std::vector<SplineStencil>& u,
                        const std::vector<SplineStencil>& v, const Matrix4d& matrix) {
    const std::span<const float> values(&pose.front().x, 3 * pose.size());
    const std::vector<double> found = crossings(*this, u, v, values, 3, weights);
    std::vector<Vec3d> points;
    for (std::size_t at = 0; at < found.size(); at += 3)
      points.push_back(moved({found[at], found[at + 1], found[at + 2]}, matrix));
    return points;
  };
  for (const std::span<const Vec3f>& pose : poses) {
    for (const Matrix4d& matrix : matrices) {
      measure(look(pose, u_fine, v_few, matrix), pixel_size, u_longest);
      measure(transposed(look(pose, u_few, v_fine, matrix), u_few.size()), pixel_size, v_longest);
    }
  }
  NurbsCells result{cells_of(u_longest, edge_pixels), cells_of(v_longest, edge_pixels)};
  if (const int times = lower(result); times > 0) {
    log.warn("uKnots", message("edges of ", edge_pixels, " pixels take more than ", kMostCells,
                               " cells; drawn with edges ", 1u << times,
                               " times as long; a larger --edge-length says so without this warning"));
  }
  return result;
}

}  // namespace msbvh::translate
