#include "core/geometry/subdivision/face_lattice.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace msbvh {

FaceLattices::FaceLattices(const LimitSurface& surface, std::vector<std::uint32_t> edge_levels)
    : surface_(surface), edge_levels_(std::move(edge_levels)) {
  std::uint64_t next = surface.cage().vertex_count;
  for (const std::uint32_t level : edge_levels_) {
    if (level > kMaxEdgeLevel)
      throw Error("dicing: an edge of level " + std::to_string(level) + "; expected 0 to " +
                  std::to_string(kMaxEdgeLevel));
    edge_first_.push_back(static_cast<std::uint32_t>(next));
    next += (std::uint64_t(1) << level) - 1;
  }
  const std::uint64_t border = next;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    face_first_.push_back(static_cast<std::uint32_t>(next));
    if (surface.has_limit(f)) next += inner_points(f);
  }
  if (next >> 32) throw Error("dicing: found " + std::to_string(next) + " points; expected fewer than 2^32");
  point_count_ = static_cast<std::uint32_t>(next);
  border_count_ = static_cast<std::uint32_t>(border);
}

std::uint32_t FaceLattices::rate(std::uint32_t face, std::uint32_t i) const {
  return 1u << edge_levels_[static_cast<std::size_t>(surface_.face_edges(face)[i])];
}

// Of a face that is cut into quarters.
std::uint32_t FaceLattices::finest(std::uint32_t face) const {
  std::uint32_t n = 2;
  for (std::uint32_t i = 0; i < surface_.face_edges(face).size(); ++i) n = std::max(n, rate(face, i));
  return n;
}

std::uint64_t FaceLattices::inner_points(std::uint32_t face) const {
  if (surface_.is_quad(face)) {
    const std::uint64_t columns = std::max(rate(face, 0), rate(face, 2));
    const std::uint64_t rows = std::max(rate(face, 1), rate(face, 3));
    return (columns - 1) * (rows - 1);
  }
  // The spokes from the edges' middles to the centre, the centre, and what lies between.
  const std::uint64_t corners = surface_.face_edges(face).size(), n = finest(face) / 2;
  return corners * (n - 1) + 1 + corners * (n - 1) * (n - 1);
}

FaceLattices::EdgePoint FaceLattices::on_edge(std::uint32_t face, std::uint32_t i, std::uint32_t k,
                                              std::uint32_t n) const {
  const auto vertices = surface_.face_vertices(face);
  const auto start = static_cast<std::uint32_t>(vertices[i]);
  const auto end = static_cast<std::uint32_t>(vertices[i + 1 == vertices.size() ? 0 : i + 1]);
  const auto edge = static_cast<std::uint32_t>(surface_.face_edges(face)[i]);
  const std::uint32_t own = rate(face, i), ratio = n / own, j = (2 * k + ratio) / (2 * ratio);
  if (j == 0) return {start, 0.0};
  if (j == own) return {end, 1.0};
  const std::uint32_t from_start = surface_.edge_start(edge) == start ? j : own - j;
  return {edge_first_[edge] + from_start - 1, double(j) / own};
}

FacePoint FaceLattices::quad_point(std::uint32_t face, std::uint32_t r, std::uint32_t c, std::uint32_t rows,
                                   std::uint32_t columns) const {
  if (r == 0) {
    const EdgePoint e = on_edge(face, 0, c, columns);
    return {e.id, 0, e.along, 0.0};
  }
  if (r == rows) {
    const EdgePoint e = on_edge(face, 2, columns - c, columns);
    return {e.id, 0, 1.0 - e.along, 1.0};
  }
  if (c == columns) {
    const EdgePoint e = on_edge(face, 1, r, rows);
    return {e.id, 0, 1.0, e.along};
  }
  if (c == 0) {
    const EdgePoint e = on_edge(face, 3, rows - r, rows);
    return {e.id, 0, 0.0, 1.0 - e.along};
  }
  return {face_first_[face] + (r - 1) * (columns - 1) + c - 1, 0, double(c) / columns, double(r) / rows};
}

SquareLattice FaceLattices::quad(std::uint32_t face) const {
  SquareLattice out{std::max(rate(face, 0), rate(face, 2)), std::max(rate(face, 1), rate(face, 3)), {}};
  for (std::uint32_t r = 0; r <= out.rows; ++r) {
    for (std::uint32_t c = 0; c <= out.columns; ++c)
      out.points.push_back(quad_point(face, r, c, out.rows, out.columns));
  }
  return out;
}

FacePoint FaceLattices::quarter_point(std::uint32_t face, std::uint32_t square, std::uint32_t r,
                                      std::uint32_t c, std::uint32_t n) const {
  const auto corners = static_cast<std::uint32_t>(surface_.face_edges(face).size());
  const std::uint32_t before = (square + corners - 1) % corners, first = face_first_[face];
  if (r == 0) {
    const EdgePoint e = on_edge(face, square, c, 2 * n);
    // Drawn along an edge of one segment to its end, which the next square has.
    if (e.along > 0.5) return {e.id, (square + 1) % corners, 0.0, 0.0};
    return {e.id, square, 2.0 * e.along, 0.0};
  }
  if (c == 0) {
    const EdgePoint e = on_edge(face, before, 2 * n - r, 2 * n);
    return {e.id, square, 0.0, 2.0 * (1.0 - e.along)};
  }
  const double s = double(c) / n, t = double(r) / n;
  if (r == n && c == n) return {first + corners * (n - 1), square, s, t};
  if (c == n) return {first + square * (n - 1) + r - 1, square, s, t};
  if (r == n) return {first + before * (n - 1) + c - 1, square, s, t};
  const std::uint32_t inside = (square * (n - 1) + r - 1) * (n - 1) + c - 1;
  return {first + corners * (n - 1) + 1 + inside, square, s, t};
}

SquareLattice FaceLattices::quarter(std::uint32_t face, std::uint32_t square) const {
  const std::uint32_t n = finest(face) / 2;
  SquareLattice out{n, n, {}};
  for (std::uint32_t r = 0; r <= n; ++r) {
    for (std::uint32_t c = 0; c <= n; ++c) out.points.push_back(quarter_point(face, square, r, c, n));
  }
  return out;
}

std::vector<SquareLattice> FaceLattices::squares(std::uint32_t face) const {
  if (surface_.is_quad(face)) return {quad(face)};
  std::vector<SquareLattice> out;
  for (std::uint32_t i = 0; i < surface_.face_edges(face).size(); ++i) out.push_back(quarter(face, i));
  return out;
}

std::vector<FacePoint> FaceLattices::distinct(const std::vector<SquareLattice>& squares) {
  std::vector<FacePoint> out;
  for (const SquareLattice& s : squares) out.insert(out.end(), s.points.begin(), s.points.end());
  std::stable_sort(out.begin(), out.end(),
                   [](const FacePoint& a, const FacePoint& b) { return a.id < b.id; });
  const auto end = std::unique(out.begin(), out.end(),
                               [](const FacePoint& a, const FacePoint& b) { return a.id == b.id; });
  out.erase(end, out.end());
  return out;
}

}  // namespace msbvh
