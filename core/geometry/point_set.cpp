#include "core/geometry/point_set.h"

#include "core/geometry/round_check.h"

namespace msbvh {

void validate(const PointSet& points) {
  const std::string part = points.name.empty() ? "points" : points.name;
  check_form(points.form(), part);
  check_vertices(points.vertices, points.form(), points.point_count, part);
}

}  // namespace msbvh
