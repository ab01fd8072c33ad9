// A cage with what does not change while it moves and is seen from elsewhere: OpenSubdiv's refined topology.
// It is made once, and evaluated for every pose and at every rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/subdivision/limit_surface.h"
#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh {

// An edge of the cage, and where the limit surface has it.
struct CageEdge {
  std::uint32_t a, b;  // vertices
  // Its ends and its middle at each of the poses that are looked at.
  std::span<const std::array<Vec3d, 3>> curves;
};
// Into how many segments an edge is cut, as a power of two: 0 to kMaxEdgeLevel.
using EdgeLevel = std::function<std::uint32_t(const CageEdge&)>;

// The level of each edge, by LimitSurface's number of it.
struct EdgeLevels {
  std::vector<std::uint32_t> of_edges;
  std::uint32_t lowered = 0;  // by how many levels, so that there are not too many points

  std::uint32_t finest() const;
  bool operator==(const EdgeLevels&) const = default;
};

// Not thread-safe: it makes surfaces when they are first asked for.
class RefinableCage {
 public:
  // Throws Error for a cage that is not valid or that OpenSubdiv refuses.
  explicit RefinableCage(Cage cage);

  const Cage& cage() const { return cage_; }
  // `poses`: of the cage's vertices, for `level` to look at; each edge is asked for once, from several
  // threads. Where there would be more than `most_points`, all levels are lowered until there are not, or are
  // 0.
  EdgeLevels edge_levels(std::span<const Vec3f* const> poses, const EdgeLevel& level,
                         std::uint64_t most_points);
  // The limit surface prepared for edges of that level; one a level, kept. It refers to this cage.
  std::shared_ptr<const LimitSurface> surface(std::uint32_t level);

  // About what it takes, the surfaces included.
  std::size_t bytes() const;

 private:
  // The first face with a limit that has an edge, and its place there; kNobody for edges of no surface.
  struct EdgeOwner {
    std::uint32_t face, place;
  };
  static constexpr std::uint32_t kNobody = 0xffffffffu;

  Cage cage_;
  std::shared_ptr<LimitSurface> coarse_;  // enough for lengths, and what the others share the topology of
  std::vector<EdgeOwner> owners_;
  std::map<std::uint32_t, std::shared_ptr<const LimitSurface>> surfaces_;
};

}  // namespace msbvh
