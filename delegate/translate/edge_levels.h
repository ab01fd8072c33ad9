// How finely the edges of a cage are cut, by their length in the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/subdivision/refined_mesh.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

// What is not in the picture is seen in reflections, shadows and by light that it sends on alone: its edges
// may be so many times as long.
inline constexpr double kLongerOutside = 8.0;

// As many segments, a power of two, as make their length next to `pixels` (0.7 to 1.4 of it) where the edge
// is seen largest, at any of a few times of the shutter.
class EdgeRule {
 public:
  // `faces`: of the mesh that `points`, in the world, are of. An edge is outside of the picture where all is
  // that the faces around it depend on.
  EdgeRule(const MeshInput& faces, const MovingArray& points, const EdgeLength& edges);

  // Of the points at the times that count.
  std::vector<const Vec3f*> poses() const;
  // `edge.curves` are of poses().
  std::uint32_t level(const CageEdge& edge) const;

 private:
  struct Instant {
    std::vector<Vec3f> pose;
    ScreenInstant screen;
    // ScreenInstant::sides_beyond() that all points have in common that the faces around a vertex depend on;
    // empty: nothing is outside.
    std::vector<std::uint8_t> beyond;
  };
  static Instant instant_at(const MeshInput& faces, const MovingArray& points, const EdgeLength& edges,
                            double time01);

  std::vector<Instant> instants_;
  double pixels_;
};

}  // namespace msbvh::translate
