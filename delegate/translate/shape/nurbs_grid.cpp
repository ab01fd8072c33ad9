#include "delegate/translate/shape/nurbs_grid.h"

#include <algorithm>
#include <array>

#include "delegate/translate/shape/grid_seams.h"

namespace msbvh::translate {
namespace {

void add_line(const SplineAxis& axis, const SplineSpan& span, double share, GridLines& lines) {
  const double parameter = span.begin * (1.0 - share) + span.end * share;
  lines.places.push_back(std::uint32_t(lines.stencils.size()));
  lines.points.push_back(std::uint32_t(lines.stencils.size()));
  lines.stencils.push_back({span.first_control, axis.basis(span, parameter).values});
  lines.segments.push_back(span.segment);
  lines.shares.push_back((parameter - span.knot_begin) / (span.knot_end - span.knot_begin));
}

// Whether all of the poses have it.
template <typename Has>
bool in_all(const NurbsPatch& patch, ControlPoses poses, std::span<const double> weights, bool along_u,
            const Has& has) {
  return std::ranges::all_of(poses, [&](const std::span<const Vec3f>& pose) {
    return has(PatchSide{patch, pose, weights, along_u});
  });
}

GridLines lines_of(const NurbsPatch& patch, const std::vector<std::uint32_t>& cells, ControlPoses poses,
                   std::span<const double> weights, bool along_u, bool apart) {
  const SplineAxis& axis = along_u ? patch.u() : patch.v();
  const std::vector<SplineSpan>& spans = axis.spans();
  const auto kinked = [&](const SplineSpan& before, const SplineSpan& after) {
    return !in_all(patch, poses, weights, along_u,
                   [&](const PatchSide& side) { return !is_kinked(side, before, after); });
  };
  GridLines lines;
  for (std::size_t s = 0; s < spans.size(); ++s) {
    const bool torn = spans[s].repeats >= axis.order();
    if (s == 0 || torn || (spans[s].repeats + 1 == axis.order() && kinked(spans[s - 1], spans[s]))) {
      add_line(axis, spans[s], 0.0, lines);
      if (s > 0 && !torn) lines.places.back() = lines.places[lines.places.size() - 2];
    }
    for (std::uint32_t i = 1; i <= cells[s]; ++i) {
      const auto from = std::uint32_t(lines.stencils.size()) - 1;
      add_line(axis, spans[s], double(i) / cells[s], lines);
      lines.cells.push_back({from, from + 1, spans[s].segment});
    }
  }
  if (in_all(patch, poses, weights, along_u, is_closed)) {
    lines.places.back() = 0;
    if (!apart && !kinked(spans.back(), spans.front())) lines.points.back() = 0;
  }
  return lines;
}

template <std::size_t kCorners>
std::size_t distinct(std::array<int, kCorners>& corners) {
  std::size_t count = 0;
  for (const int corner : corners) {
    if (count == 0 || corner != corners[count - 1]) corners[count++] = corner;
  }
  while (count > 1 && corners[count - 1] == corners[0]) --count;
  return count;
}

// Two corners of values that are linear between knots, and the share of the second.
struct Between {
  std::size_t first;
  double share;
};
Between between(const GridLines& lines, std::uint32_t line) {
  return {lines.segments[line], lines.shares[line]};
}

}  // namespace

NurbsGrid::NurbsGrid(const NurbsPatch& patch, const NurbsCells& cells, ControlPoses poses,
                     std::span<const double> weights, bool apart)
    : patch_(patch),
      u_(lines_of(patch, cells.u, poses, weights, true, apart)),
      v_(lines_of(patch, cells.v, poses, weights, false, apart)) {
  for (const bool at_end : {false, true}) {
    const auto pole = [&](const PatchSide& side) { return is_pole(side, at_end); };
    u_poles_[at_end] = in_all(patch, poses, weights, true, pole);
    v_poles_[at_end] = in_all(patch, poses, weights, false, pole);
  }
  make_faces(apart);
}

// In a pole, the first of its points.
NurbsGrid::Node NurbsGrid::place_of(Node node) const {
  const bool ends[4] = {u_poles_[0] && node.u == 0, u_poles_[1] && node.u + 1 == u_.stencils.size(),
                        v_poles_[0] && node.v == 0, v_poles_[1] && node.v + 1 == v_.stencils.size()};
  if (ends[0] || ends[1]) node.v = 0;
  if (ends[2] || ends[3]) node.u = 0;
  return node;
}

void NurbsGrid::make_faces(bool apart) {
  const std::size_t columns = u_.stencils.size();
  std::vector<int> ids(columns * v_.stencils.size(), -1);
  const auto point = [&](std::uint32_t u, std::uint32_t v) {
    const Node own{u_.points[u], v_.points[v]}, node = apart ? own : place_of(own);
    int& id = ids[node.v * columns + node.u];
    if (id < 0) {
      id = int(points_.size());
      points_.push_back(node);
    }
    return id;
  };
  for (const GridLines::Cell& v : v_.cells) {
    for (const GridLines::Cell& u : u_.cells) {
      std::array<int, 4> corners{point(u.from, v.from), point(u.to, v.from), point(u.to, v.to),
                                 point(u.from, v.to)};
      const std::size_t count = distinct(corners);
      if (count < 3) continue;
      counts_.push_back(int(count));
      indices_.insert(indices_.end(), corners.begin(), corners.begin() + std::ptrdiff_t(count));
      segments_.push_back(int(v.segment * patch_.u().segment_count() + u.segment));
    }
  }
}

std::vector<float> NurbsGrid::positions(std::span<const float> values,
                                        std::span<const double> weights) const {
  const std::vector<double> found = crossings(patch_, u_.stencils, v_.stencils, values, 3, weights);
  std::vector<float> result;
  result.reserve(3 * points_.size());
  for (const Node& node : points_) {
    const Node place = place_of({u_.places[node.u], v_.places[node.v]});
    const double* from = &found[3 * (place.v * u_.stencils.size() + place.u)];
    for (int k = 0; k < 3; ++k) result.push_back(float(from[k]));
  }
  return result;
}

std::vector<float> NurbsGrid::vertex_values(std::span<const float> values, std::size_t width,
                                            std::span<const double> weights) const {
  const std::vector<double> found = crossings(patch_, u_.stencils, v_.stencils, values, width, weights);
  std::vector<float> result;
  result.reserve(width * points_.size());
  for (const Node& node : points_) {
    const double* from = &found[width * (node.v * u_.stencils.size() + node.u)];
    for (std::size_t k = 0; k < width; ++k) result.push_back(float(from[k]));
  }
  return result;
}

std::vector<float> NurbsGrid::varying_values(std::span<const float> values, std::size_t width) const {
  const std::size_t columns = patch_.u().segment_count() + 1;
  std::vector<float> result;
  result.reserve(width * points_.size());
  for (const Node& node : points_) {
    const Between u = between(u_, node.u), v = between(v_, node.v);
    for (std::size_t k = 0; k < width; ++k) {
      const auto at = [&](std::size_t i, std::size_t j) {
        return double(values[((v.first + j) * columns + u.first + i) * width + k]);
      };
      const double low = at(0, 0) * (1.0 - u.share) + at(1, 0) * u.share;
      const double high = at(0, 1) * (1.0 - u.share) + at(1, 1) * u.share;
      result.push_back(float(low * (1.0 - v.share) + high * v.share));
    }
  }
  return result;
}

}  // namespace msbvh::translate
