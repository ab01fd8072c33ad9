#include "delegate/translate/shape/grid_seams.h"

#include <cmath>
#include <vector>

#include "core/base/box.h"

namespace msbvh::translate {
namespace {

using Stencils = std::vector<SplineStencil>;

// Across the direction, a few places a span; by the basis or its derivative.
Stencils across(const SplineAxis& axis, bool derivative) {
  constexpr double kWhere[] = {0.0, 0.21, 0.5, 0.79, 1.0};
  Stencils result;
  for (const SplineSpan& span : axis.spans()) {
    for (const double w : kWhere) {
      SplineAxis::Basis basis = axis.basis(span, span.begin * (1.0 - w) + span.end * w);
      result.push_back({span.first_control, std::move(derivative ? basis.derivatives : basis.values)});
    }
  }
  return result;
}

SplineStencil stencil(const SplineAxis& axis, const SplineSpan& span, bool at_end, bool derivative) {
  SplineAxis::Basis basis = axis.basis(span, at_end ? span.end : span.begin);
  return {span.first_control, std::move(derivative ? basis.derivatives : basis.values)};
}

struct Weighted {
  Vec3d sum;
  double weight;
};

// Along a line of the surface. `line` is of the direction, `places` across it.
std::vector<Weighted> weighted(const PatchSide& side, const SplineStencil& line, const Stencils& places) {
  const std::span<const SplineStencil> one(&line, 1);
  const std::span<const float> values(&side.pose.front().x, 3 * side.pose.size());
  const std::vector<double> found =
      side.along_u ? weighted_crossings(side.patch, one, places, values, 3, side.weights)
                   : weighted_crossings(side.patch, places, one, values, 3, side.weights);
  std::vector<Weighted> result;
  for (std::size_t at = 0; at < found.size(); at += 4)
    result.push_back({{found[at], found[at + 1], found[at + 2]}, found[at + 3]});
  return result;
}

std::vector<Vec3d> points(const PatchSide& side, const SplineSpan& span, bool at_end) {
  std::vector<Vec3d> result;
  const SplineStencil line = stencil(side.axis(), span, at_end, false);
  for (const auto& [sum, weight] : weighted(side, line, across(side.across(), false)))
    result.push_back(sum * (1.0 / weight));
  return result;
}

// At one end of a span, of length 1; 0 where there is none.
std::vector<Vec3d> normals(const PatchSide& side, const SplineSpan& span, bool at_end) {
  const Stencils places = across(side.across(), false);
  const SplineStencil line = stencil(side.axis(), span, at_end, false);
  const std::vector<Weighted> at = weighted(side, line, places);
  const std::vector<Weighted> along = weighted(side, stencil(side.axis(), span, at_end, true), places);
  const std::vector<Weighted> crosswise = weighted(side, line, across(side.across(), true));
  std::vector<Vec3d> result;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3d point = at[i].sum * (1.0 / at[i].weight);
    const Vec3d d = along[i].sum - point * along[i].weight,
                e = crosswise[i].sum - point * crosswise[i].weight;
    const Vec3d normal = cross(d, e);
    const double size = length(normal);
    result.push_back(size > 1e-9 * length(d) * length(e) ? normal * (1.0 / size) : Vec3d{0.0, 0.0, 0.0});
  }
  return result;
}

double size_of(std::span<const Vec3f> pose) {
  Box3d box;
  for (const Vec3f& point : pose) box.grow(Vec3d(point));
  return length(box.hi - box.lo);
}

}  // namespace

bool is_kinked(const PatchSide& side, const SplineSpan& before, const SplineSpan& after) {
  const std::vector<Vec3d> a = normals(side, before, true), b = normals(side, after, false);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (length(a[i]) > 0.0 && length(b[i]) > 0.0 && length(a[i] - b[i]) > kKinkAngle) return true;
  }
  return false;
}

bool is_closed(const PatchSide& side) {
  const std::vector<Vec3d> first = points(side, side.axis().spans().front(), false);
  const std::vector<Vec3d> last = points(side, side.axis().spans().back(), true);
  const double most = kSamePlace * size_of(side.pose);
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!(length(first[i] - last[i]) <= most)) return false;
  }
  return true;
}

bool is_pole(const PatchSide& side, bool at_end) {
  const SplineSpan& span = at_end ? side.axis().spans().back() : side.axis().spans().front();
  const std::vector<Vec3d> all = points(side, span, at_end);
  const double most = kSamePlace * size_of(side.pose);
  for (const Vec3d& point : all) {
    if (!(length(point - all.front()) <= most)) return false;
  }
  return true;
}

}  // namespace msbvh::translate
