#include "core/geometry/subdivision/refinable_cage.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/geometry/subdivision/face_lattice.h"

namespace msbvh {
namespace {

constexpr std::size_t kFacesPerTask = 16;
// Of OpenSubdiv's refinement, which is enough to measure edges with.
constexpr std::uint32_t kLevelForLengths = 2;

// What a level of OpenSubdiv 3.5 takes, by the sizes of its arrays.
constexpr std::size_t kBytesPerCorner = 24, kBytesPerEdge = 34, kBytesPerVertex = 22;

Cage validated(Cage cage) {
  validate(cage);
  return cage;
}

// A face's i-th edge, from vertex i to the next.
std::array<Vec3d, 3> edge_curve(const LimitSurface& surface, const FaceSurface& face, std::uint32_t f,
                                std::uint32_t i) {
  const auto at = [&](std::uint32_t square, double s, double t) {
    return face.evaluate(square, s, t).position;
  };
  if (!surface.is_quad(f)) {
    const auto next = (i + 1) % static_cast<std::uint32_t>(surface.face_edges(f).size());
    return {at(i, 0.0, 0.0), at(i, 1.0, 0.0), at(next, 0.0, 0.0)};
  }
  constexpr double kCorners[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  const double *p = kCorners[i], *q = kCorners[i + 1];
  return {at(0, p[0], p[1]), at(0, 0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])), at(0, q[0], q[1])};
}

// About how many points there are at such levels: no fewer than inside the faces.
std::uint64_t points_at(const LimitSurface& surface, const std::vector<std::uint32_t>& levels,
                        std::uint32_t lowered) {
  std::uint64_t points = surface.cage().vertex_count;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto edges = surface.face_edges(f);
    const auto rate = [&](std::size_t i) {
      const std::uint32_t level = levels[static_cast<std::size_t>(edges[i])];
      return std::uint64_t(1) << (level - std::min(level, lowered));
    };
    if (surface.is_quad(f)) {
      points += std::max(rate(0), rate(2)) * std::max(rate(1), rate(3));
      continue;
    }
    std::uint64_t finest = 2;
    for (std::size_t i = 0; i < edges.size(); ++i) finest = std::max(finest, rate(i));
    points += edges.size() * (finest / 2) * (finest / 2);
  }
  return points;
}

}  // namespace

std::uint32_t EdgeLevels::finest() const {
  return of_edges.empty() ? 0 : *std::ranges::max_element(of_edges);
}

RefinableCage::RefinableCage(Cage cage)
    : cage_(validated(std::move(cage))), coarse_(std::make_shared<LimitSurface>(cage_, kLevelForLengths)) {
  owners_.assign(coarse_->edge_count(), {kNobody, 0});
  for (std::uint32_t f = 0; f < coarse_->face_count(); ++f) {
    if (!coarse_->has_limit(f)) continue;
    const auto edges = coarse_->face_edges(f);
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      EdgeOwner& owner = owners_[static_cast<std::size_t>(edges[i])];
      if (owner.face == kNobody) owner = {f, i};
    }
  }
}

EdgeLevels RefinableCage::edge_levels(std::span<const Vec3f* const> poses, const EdgeLevel& level,
                                      std::uint64_t most_points) {
  const LimitSurface& surface = *coarse_;
  std::vector<std::uint32_t> levels(surface.edge_count(), 0);
  parallel_for_ranges(surface.face_count(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      if (!surface.has_limit(f)) continue;
      const auto edges = surface.face_edges(f), vertices = surface.face_vertices(f);
      std::vector<std::vector<std::array<Vec3d, 3>>> curves(edges.size());
      FaceSurface face(surface, f);
      for (const Vec3f* pose : poses) {
        face.set_values(&pose->x, 3);
        for (std::uint32_t i = 0; i < edges.size(); ++i) {
          if (owners_[static_cast<std::size_t>(edges[i])].face == f)
            curves[i].push_back(edge_curve(surface, face, f, i));
        }
      }
      for (std::uint32_t i = 0; i < edges.size(); ++i) {
        const auto edge = static_cast<std::size_t>(edges[i]);
        if (owners_[edge].face != f || owners_[edge].place != i) continue;
        const auto a = static_cast<std::uint32_t>(vertices[i]);
        const auto b = static_cast<std::uint32_t>(vertices[(i + 1) % vertices.size()]);
        levels[edge] = std::min(kMaxEdgeLevel, level({a, b, curves[i]}));
      }
    }
  });
  EdgeLevels result{std::move(levels), 0};
  const std::uint32_t finest = result.finest();
  while (result.lowered < finest && points_at(surface, result.of_edges, result.lowered) > most_points)
    ++result.lowered;
  for (std::uint32_t& l : result.of_edges) l -= std::min(l, result.lowered);
  return result;
}

std::shared_ptr<const LimitSurface> RefinableCage::surface(std::uint32_t level) {
  std::shared_ptr<const LimitSurface>& kept = surfaces_[level];
  if (!kept) kept = std::make_shared<LimitSurface>(*coarse_, level);
  return kept;
}

std::size_t RefinableCage::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  std::size_t total = of(cage_.face_vertex_counts) + of(cage_.face_vertex_indices) + of(cage_.holes) +
                      of(cage_.crease_lengths) + of(cage_.crease_indices) + of(cage_.crease_sharpnesses) +
                      of(cage_.corner_indices) + of(cage_.corner_sharpnesses) + of(owners_);
  for (const FaceVaryingTopology& channel : cage_.face_varying)
    total += of(channel.indices) + kBytesPerCorner * channel.indices.size();
  total += kBytesPerCorner * cage_.face_vertex_indices.size() + kBytesPerEdge * owners_.size() +
           kBytesPerVertex * cage_.vertex_count;
  total += coarse_->irregular_bytes();
  for (const auto& [level, surface] : surfaces_) total += surface->irregular_bytes();
  return total;
}

}  // namespace msbvh
