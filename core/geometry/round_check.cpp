#include "core/geometry/round_check.h"

#include <cmath>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {
namespace {

std::string place(std::size_t i, std::size_t count) {
  return "vertices: vertex " + std::to_string(i % count) + " at control " + std::to_string(i / count);
}

}  // namespace

void check_form(const TrackForm& form, const std::string& part) {
  if (is_valid_form(form)) return;
  throw Error(part + ": segments, degree: found " + std::to_string(form.segments) + ", " +
              std::to_string(form.degree) + "; expected 0 or a power of two up to " +
              std::to_string(kMaxSegments) + ", and 1 to " + std::to_string(kMaxDegree) +
              ", 1 where nothing moves");
}

void check_vertices(const std::vector<RoundVertex>& vertices, const TrackForm& form, std::size_t count,
                    const std::string& part) {
  if (vertices.size() != form.controls() * count) {
    throw Error(part + ": vertices: found " + std::to_string(vertices.size()) + "; expected " +
                std::to_string(form.controls()) + " controls x " + std::to_string(count));
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const RoundVertex& v = vertices[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(v.p[axis]) <= kMaxCoordinate) continue;  // false for NaN too
      throw Error(part + ": " + place(i, count) + " has the coordinate " + std::to_string(v.p[axis]) +
                  "; expected a finite number of at most 2^60 in size");
    }
    if (v.radius >= 0.0f && v.radius <= kMaxCoordinate) continue;
    throw Error(part + ": " + place(i, count) + " has the radius " + std::to_string(v.radius) +
                "; expected 0 to 2^60");
  }
}

}  // namespace msbvh
