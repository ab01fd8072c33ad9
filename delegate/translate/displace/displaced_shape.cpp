#include "delegate/translate/displace/displaced_shape.h"

#include <algorithm>
#include <utility>

#include "delegate/translate/displace/displaced_surface.h"

namespace msbvh::translate {
namespace {

bool check_displaced(const TriangleMesh& mesh, PrimLog& log) {
  const auto in_range = [](const Vec3f& p) {
    const Vec3f size = abs(p);
    return size.x <= kMaxCoordinate && size.y <= kMaxCoordinate && size.z <= kMaxCoordinate;
  };
  const auto bad = std::ranges::find_if_not(mesh.positions, in_range);
  if (bad == mesh.positions.end()) return true;
  log.warn("material:binding",
           message("displaced to (", bad->x, ", ", bad->y, ", ", bad->z,
                   "); expected coordinates of at most 2^60 in size; drawn without displacement"));
  return false;
}

}  // namespace

std::optional<DisplacedShape> displaced_shape(const MeshInput& input, const FaceDisplacements& displacements,
                                              const MovingArray& points, const Tessellation& faces,
                                              const ScreenMeasure& measure, const FitSettings& settings,
                                              PrimLog& log) {
  if (!displacements.any()) return std::nullopt;
  PointDistances distances = point_distances(input, faces, displacements, log);
  const double largest = distances.largest();
  if (largest == 0.0) return std::nullopt;
  if (!faces.refinement()) {
    log.warn_in_common(
        "subdivisionScheme",
        "displacement moves the vertices of polygons alone; a subdivided mesh shows all of it");
  }
  const DisplacedSurface surface(points, faces, std::move(distances));
  const std::uint64_t most = kMostRefinedPoints / std::max<std::size_t>(1, surface.size());
  DisplacedShape result{{}, fit_displaced(surface, measure, settings, most)};
  result.shape = empty_shape(result.fit.track, faces, input.path);
  result.shape.mesh.vertex_count = std::uint32_t(surface.size());
  result.shape.mesh.positions = displaced_controls(surface, result.fit.track);
  result.shape.displaced_by = largest;
  if (!check_displaced(result.shape.mesh, log)) return std::nullopt;
  return result;
}

}  // namespace msbvh::translate
