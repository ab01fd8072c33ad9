#include "delegate/translate/stray/displaced_stray.h"

#include <algorithm>
#include <cstdint>

#include "core/base/parallel.h"
#include "delegate/translate/displace/distances.h"
#include "delegate/translate/mesh.h"
#include "delegate/translate/stray/refined_stray.h"
#include "delegate/translate/stray/square_places.h"

namespace msbvh::translate {
namespace {

// A mesh's points in its own space, where distances are what the material says, and what places them.
struct OwnInstant {
  std::vector<Vec3f> pose;  // less `shift`
  Vec3d shift;
  Affine3d map;
  ScreenInstant screen;
  PlaceDistances distances;

  std::vector<Vec3d> displaced(const FaceSurface& limit, std::uint32_t face,
                               const SquareLattice& square) const {
    std::vector<double> by(square.points.size());
    distances.at_squares(face, {&square, 1}, by.data());
    std::vector<Vec3d> result;
    result.reserve(by.size());
    for (std::size_t i = 0; i < by.size(); ++i) {
      const FacePoint& p = square.points[i];
      const LimitPoint at = limit.evaluate(p.square, p.s, p.t);
      result.push_back(map.point(at.position + normalize(cross(at.du, at.dv)) * by[i] + shift));
    }
    return result;
  }
};

std::vector<Vec3f> own_pose(const MovingArray& points, double time01, const Vec3d& shift) {
  const ArrayInstant values = points.values.at(time01, time01);
  std::vector<Vec3f> pose;
  pose.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) pose.push_back(Vec3f(values[i] - shift));
  return pose;
}

double face_stray(const RefinedMesh& mesh, const LimitSurface& surface, std::uint32_t face,
                  const OwnInstant& instant) {
  FaceSurface limit(surface, face);
  limit.set_values(&instant.pose.data()->x, 3);
  WorstStray worst(instant.screen);
  const std::vector<SquareLattice> squares = mesh.squares_of(face);
  for (std::uint32_t s = 0; s < squares.size(); ++s) {
    const SquarePlaces places(surface, face, squares[s], s);
    places.add_to(
        worst, instant.screen,
        {instant.displaced(limit, face, squares[s]), instant.displaced(limit, face, places.halves()), {}});
  }
  return worst.pixels();
}

}  // namespace

double displaced_stray(const MeshInput& input, const FaceDisplacements& displacements,
                       const Tessellation& drawn, const MovingArray& points, const ScreenMeasure& measure) {
  const RefinedMesh& mesh = *drawn.refinement()->mesh;
  const LimitSurface surface(mesh.surface(), mesh.level() + kStrayLevels);
  const std::vector<std::uint32_t>& faces = mesh.drawn_faces();
  const Vec3d shift = exact_origin(bounds({points.values, TransformTrack(Affine3d{})}));
  std::vector<double> of_faces(faces.size());
  for (const double time01 : stray_times01(points, measure, displacements.is_still())) {
    const OwnInstant instant{own_pose(points, time01, shift), shift, points.transform.at(time01, time01),
                             measure.at(time01), PlaceDistances(input, drawn, displacements, time01)};
    parallel_for(faces.size(), [&](std::size_t i) {
      of_faces[i] = std::max(of_faces[i], face_stray(mesh, surface, faces[i], instant));
    });
  }
  return of_faces.empty() ? 0.0 : *std::ranges::max_element(of_faces);
}

}  // namespace msbvh::translate
