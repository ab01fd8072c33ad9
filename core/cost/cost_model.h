// What rays' work takes, in units of one still node's test. Prices, not laws: medians over spheres, soups,
// curves, points, patches and instances, alone and many at once, whose extremes lie a factor of two and more
// apart (docs/design/ray_costs.md).
#pragma once

#include "core/build/settings.h"
#include "core/geometry/geometry_id.h"
#include "core/motion/track.h"

namespace msbvh {

struct CostModel {
  double block;           // 8 triangles: the builder's own price
  double instance = 3.0;  // the way into one, and out
  double points = 2.0;    // 8 of them, in blocks of triangles
  double tile = 2.0;      // of a displaced patch, 16 triangles; likewise
  double curves = 6.0;    // 8 pieces; likewise
  // Nodes and blocks whose controls are interpolated, by the degree of the geometry's own track.
  double linear = 1.5, quadratic = 1.75, cubic = 2.1;

  explicit CostModel(const BuildSettings& build) : block(build.block_cost) {}

  double of_block(GeometryKind kind) const {
    switch (kind) {
      case GeometryKind::kTriangleMesh:
        break;
      case GeometryKind::kGridMesh:
        return tile * block;
      case GeometryKind::kCurves:
        return curves * block;
      case GeometryKind::kPoints:
        return points * block;
    }
    return block;
  }
  double of_motion(const TrackForm& form) const {
    if (!form.moving()) return 1.0;
    return form.degree == 1 ? linear : form.degree == 2 ? quadratic : cubic;
  }
};

}  // namespace msbvh
