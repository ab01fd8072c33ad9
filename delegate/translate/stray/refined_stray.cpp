#include "delegate/translate/stray/refined_stray.h"

#include <algorithm>
#include <cstdint>

#include "core/base/parallel.h"
#include "delegate/translate/stray/square_places.h"

namespace msbvh::translate {
namespace {

double face_stray(const RefinedMesh& mesh, const LimitSurface& surface, std::uint32_t face,
                  std::span<const StrayInstant> instants) {
  const std::vector<SquareLattice> squares = mesh.squares_of(face);
  std::vector<SquarePlaces> places;
  for (std::uint32_t s = 0; s < squares.size(); ++s) places.emplace_back(surface, face, squares[s], s);
  FaceSurface limit(surface, face);
  const auto at = [&](const std::vector<FacePoint>& points) {
    std::vector<Vec3d> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      limit.evaluate(points[i].square, points[i].s, points[i].t, &result[i].x);
    return result;
  };
  double worst = 0.0;
  for (const StrayInstant& instant : instants) {
    limit.set_values(&instant.pose.data()->x, 3);
    WorstStray here(instant.screen);
    for (const SquarePlaces& square : places) {
      const std::vector<Vec3d> halves = at(square.halves().points);
      square.add_to(here, instant.screen, {square.points_of(halves), halves, at(square.middles())});
    }
    worst = std::max(worst, here.pixels());
  }
  return worst;
}

}  // namespace

double refined_stray(const RefinedMesh& mesh, std::span<const StrayInstant> instants) {
  const LimitSurface surface(mesh.surface(), mesh.level() + kStrayLevels);
  const std::vector<std::uint32_t>& faces = mesh.drawn_faces();
  std::vector<double> of_faces(faces.size());
  parallel_for(faces.size(),
               [&](std::size_t i) { of_faces[i] = face_stray(mesh, surface, faces[i], instants); });
  return of_faces.empty() ? 0.0 : *std::ranges::max_element(of_faces);
}

}  // namespace msbvh::translate
