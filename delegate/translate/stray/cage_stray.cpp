#include "delegate/translate/stray/cage_stray.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/triangle_distance.h"
#include "core/geometry/subdivision/limit_surface.h"
#include "delegate/translate/cage.h"

namespace msbvh::translate {
namespace {

constexpr std::uint32_t kLevel = 2;            // of the lattice
constexpr std::uint32_t kCells = 1 << kLevel;  // along an edge

// The limit surface of a face at one time: the lattice of each of its squares.
struct FaceLimit {
  std::uint32_t cells = 0;  // along a square's side
  std::vector<Vec3d> points;

  double distance_to(const Vec3d& point) const;
};

double FaceLimit::distance_to(const Vec3d& point) const {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t stride = cells + 1;
  for (std::size_t first = 0; first < points.size(); first += stride * stride) {
    for (std::size_t r = 0; r < cells; ++r) {
      for (std::size_t c = 0; c < cells; ++c) {
        const Vec3d* p = &points[first + r * stride + c];
        least = std::min({least, distance_to_triangle(point, {p[0], p[1], p[stride + 1]}),
                          distance_to_triangle(point, {p[0], p[stride + 1], p[stride]})});
      }
    }
  }
  return least;
}

class CageStray {
 public:
  CageStray(const InputCage& cage, const Triangulation& polygons)
      : cage_(cage), polygons_(polygons), surface_(cage.cage, kLevel), faces_at_(cage.cage.vertex_count) {
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (!surface_.has_limit(f)) continue;
      drawn_.push_back(f);
      for (const int vertex : surface_.face_vertices(f)) faces_at_[std::size_t(vertex)].push_back(f);
    }
    first_triangle_.assign(polygons.face_count + 1, 0);
    for (const std::uint32_t face : polygons.faces) ++first_triangle_[face + 1];
    for (std::size_t f = 0; f < polygons.face_count; ++f) first_triangle_[f + 1] += first_triangle_[f];
  }

  double worst(const StrayInstant& instant) const;

 private:
  FaceLimit limit_of(std::uint32_t face, const StrayInstant& instant) const;
  std::vector<std::uint32_t> faces_around(std::uint32_t face) const;
  void add_polygons(std::uint32_t face, const StrayInstant& instant, std::vector<TriangleCorners>& out) const;
  double of_face(std::uint32_t face, const StrayInstant& instant, const std::vector<FaceLimit>& limits) const;

  const InputCage& cage_;
  const Triangulation& polygons_;
  LimitSurface surface_;
  std::vector<std::uint32_t> drawn_;
  std::vector<std::vector<std::uint32_t>> faces_at_;  // each vertex
  std::vector<std::uint32_t> first_triangle_;         // of each of the input's faces
};

double nearest(const Vec3d& point, const std::vector<TriangleCorners>& triangles) {
  double least = std::numeric_limits<double>::infinity();
  for (const TriangleCorners& triangle : triangles)
    least = std::min(least, distance_to_triangle(point, triangle));
  return least;
}

FaceLimit CageStray::limit_of(std::uint32_t face, const StrayInstant& instant) const {
  FaceSurface limit(surface_, face);
  limit.set_values(&instant.pose.data()->x, 3);
  const bool quad = surface_.is_quad(face);
  const auto squares = quad ? 1u : std::uint32_t(surface_.face_vertices(face).size());
  const std::uint32_t n = quad ? kCells : kCells / 2;
  FaceLimit result{n, {}};
  for (std::uint32_t square = 0; square < squares; ++square) {
    for (std::uint32_t r = 0; r <= n; ++r) {
      for (std::uint32_t c = 0; c <= n; ++c)
        limit.evaluate(square, double(c) / n, double(r) / n, &result.points.emplace_back().x);
    }
  }
  return result;
}

// Those that share a vertex with it, itself included.
std::vector<std::uint32_t> CageStray::faces_around(std::uint32_t face) const {
  std::vector<std::uint32_t> result;
  for (const int vertex : surface_.face_vertices(face)) {
    const std::vector<std::uint32_t>& here = faces_at_[std::size_t(vertex)];
    result.insert(result.end(), here.begin(), here.end());
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

void CageStray::add_polygons(std::uint32_t face, const StrayInstant& instant,
                             std::vector<TriangleCorners>& out) const {
  const std::uint32_t input_face = cage_.faces.empty() ? face : cage_.faces[face];
  for (std::uint32_t i = first_triangle_[input_face]; i < first_triangle_[input_face + 1]; ++i) {
    const Triangle& t = polygons_.triangles[i];
    out.push_back({Vec3d(instant.pose[t[0]]), Vec3d(instant.pose[t[1]]), Vec3d(instant.pose[t[2]])});
  }
}

// `limits`: by face, of those that have one.
double CageStray::of_face(std::uint32_t face, const StrayInstant& instant,
                          const std::vector<FaceLimit>& limits) const {
  std::vector<Vec3d> vertices;
  for (const int vertex : surface_.face_vertices(face))
    vertices.emplace_back(instant.pose[std::size_t(vertex)]);
  const auto in_picture = [&] {
    std::vector<Vec3d> all = limits[face].points;
    all.insert(all.end(), vertices.begin(), vertices.end());
    return may_be_in_picture(instant.screen, all);
  };
  if (!in_picture()) return 0.0;
  WorstStray worst(instant.screen);
  const auto counts = [] { return true; };
  std::vector<TriangleCorners> polygons;
  for (const std::uint32_t near : faces_around(face)) add_polygons(near, instant, polygons);
  for (const Vec3d& p : limits[face].points) worst.add(nearest(p, polygons), p, counts);
  const std::span<const int> indices = surface_.face_vertices(face);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t near : faces_at_[std::size_t(indices[i])])
      least = std::min(least, limits[near].distance_to(vertices[i]));
    worst.add(least, vertices[i], counts);
  }
  return worst.pixels();
}

double CageStray::worst(const StrayInstant& instant) const {
  std::vector<FaceLimit> limits(surface_.face_count());
  parallel_for(drawn_.size(), [&](std::size_t i) { limits[drawn_[i]] = limit_of(drawn_[i], instant); });
  std::vector<double> of_faces(drawn_.size());
  parallel_for(drawn_.size(), [&](std::size_t i) { of_faces[i] = of_face(drawn_[i], instant, limits); });
  return of_faces.empty() ? 0.0 : *std::ranges::max_element(of_faces);
}

}  // namespace

std::optional<double> cage_stray(const MeshInput& input, const Triangulation& polygons,
                                 std::size_t point_count, std::span<const StrayInstant> instants) {
  std::vector<Diagnostic> unsaid;  // what is wrong with the cage has been said, or nobody asked for it
  PrimLog log(unsaid, input.path);
  const std::optional<InputCage> cage = cage_of(input, point_count, log);
  if (!cage) return std::nullopt;
  try {
    validate(cage->cage);
    const CageStray stray(*cage, polygons);
    double worst = 0.0;
    for (const StrayInstant& instant : instants) worst = std::max(worst, stray.worst(instant));
    return worst;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace msbvh::translate
