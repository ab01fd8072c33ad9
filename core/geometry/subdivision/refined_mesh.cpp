#include "core/geometry/subdivision/refined_mesh.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace msbvh {
namespace {

constexpr std::size_t kFacesPerTask = 16;
constexpr std::uint32_t kNobody = 0xffffffffu;

}  // namespace

RefinedMesh::RefinedMesh(Cage cage, std::span<const Vec3f* const> poses, const EdgeLevel& level,
                         std::uint64_t most_points)
    : RefinedMesh(std::make_shared<RefinableCage>(std::move(cage)), poses, level, most_points) {}

RefinedMesh::RefinedMesh(std::shared_ptr<RefinableCage> cage, std::span<const Vec3f* const> poses,
                         const EdgeLevel& level, std::uint64_t most_points)
    : RefinedMesh(cage, cage->edge_levels(poses, level, most_points)) {}

RefinedMesh::RefinedMesh(std::shared_ptr<RefinableCage> cage, EdgeLevels levels)
    : cage_(std::move(cage)),
      level_(levels.finest()),
      surface_(cage_->surface(level_)),
      lattices_(std::make_unique<FaceLattices>(*surface_, std::move(levels.of_edges))),
      lowered_(levels.lowered),
      creased_(surface_->has_creases()) {
  for (std::uint32_t f = 0; f < surface_->face_count(); ++f) {
    if (surface_->has_limit(f)) drawn_.push_back(f);
  }
  own_borders();
  make_triangles();
}

std::size_t RefinedMesh::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return of(drawn_) + of(first_triangle_) + of(border_owner_) + of(border_point_) + of(triangles_) +
         of(faces_) + sizeof(std::uint32_t) * (surface_->edge_count() * 2 + surface_->face_count());
}

// Points on edges and at vertices belong to the first face that has them.
void RefinedMesh::own_borders() {
  border_owner_.assign(lattices_->border_count(), kNobody);
  for (std::uint32_t i = 0; i < drawn_.size(); ++i) {
    for (const SquareLattice& square : lattices_->squares(drawn_[i])) {
      for (const FacePoint& p : square.points) {
        if (p.id < border_owner_.size()) border_owner_[p.id] = std::min(border_owner_[p.id], i);
      }
    }
  }
  border_point_.assign(border_owner_.size(), kNobody);
  for (std::size_t id = 0; id < border_owner_.size(); ++id) {
    if (border_owner_[id] != kNobody) border_point_[id] = border_points_++;
  }
  point_count_ = border_points_ + lattices_->point_count() - lattices_->border_count();
}

void RefinedMesh::make_triangles() {
  std::vector<std::uint32_t> count(drawn_.size());
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    for_triangles(squares, [&](const auto&...) { ++count[i]; });
  });
  std::uint64_t total = 0;
  for (const std::uint32_t n : count) {
    first_triangle_.push_back(static_cast<std::uint32_t>(total));
    total += n;
  }
  if (total >> 31)
    throw Error(cage().name + ": subdivided into " + std::to_string(total) +
                " triangles; expected fewer than 2^31");
  triangles_.resize(total);
  faces_.resize(total);
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    std::size_t at = first_triangle_[i];
    for_triangles(squares, [&](const auto&... corners) {
      triangles_[at] = {point(squares[corners.square].points[corners.point].id)...};
      faces_[at++] = drawn_[i];
    });
  });
}

// `visit(i, squares)`: the i-th of drawn_; from several threads.
template <typename Visit>
void RefinedMesh::for_faces(const Visit& visit) const {
  parallel_for_ranges(drawn_.size(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) visit(i, lattices_->squares(drawn_[i]));
  });
}

// `visit(a, b, c)`.
template <typename Visit>
void RefinedMesh::for_triangles(const std::vector<SquareLattice>& squares, const Visit& visit) const {
  for (std::uint32_t s = 0; s < squares.size(); ++s) {
    squares[s].for_triangles([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      visit(Corner{s, a}, Corner{s, b}, Corner{s, c});
    });
  }
}

// `evaluate(surface, place, point)` for each point, by the face that owns it.
template <typename Evaluate>
void RefinedMesh::evaluate_points(ValueKind kind, const Evaluate& evaluate) const {
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    FaceSurface surface(*surface_, drawn_[i], kind);
    std::vector<FacePoint> points = FaceLattices::distinct(squares);
    std::erase_if(
        points, [&](const FacePoint& p) { return p.id < border_owner_.size() && border_owner_[p.id] != i; });
    evaluate(surface, points);
  });
}

void RefinedMesh::at_points(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                            std::span<float* const> out) const {
  evaluate_points(kind, [&](FaceSurface& surface, const std::vector<FacePoint>& points) {
    std::vector<double> value(width);
    for (std::size_t c = 0; c < controls.size(); ++c) {
      surface.set_values(controls[c], width);
      for (const FacePoint& p : points) {
        surface.evaluate(p.square, p.s, p.t, value.data());
        float* to = out[c] + std::size_t(width) * point(p.id);
        for (const double v : value) *to++ = static_cast<float>(v);
      }
    }
  });
}

// `at_place(place)` for each place of a face once, then where triangles meet it.
template <typename Place, typename Out>
void RefinedMesh::write_corners(const std::vector<SquareLattice>& squares, std::size_t width,
                                const Place& at_place, Out* to) const {
  std::vector<std::vector<Out>> values(squares.size());
  for (std::size_t s = 0; s < squares.size(); ++s) {
    values[s].resize(width * squares[s].points.size());
    for (std::size_t p = 0; p < squares[s].points.size(); ++p)
      at_place(squares[s].points[p], values[s].data() + width * p);
  }
  const auto write = [&](const Corner& corner) {
    to = std::copy_n(values[corner.square].data() + width * corner.point, width, to);
  };
  for_triangles(squares, [&](const auto&... corners) { (write(corners), ...); });
}

void RefinedMesh::at_corners(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                             std::span<float* const> out) const {
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    FaceSurface surface(*surface_, drawn_[i], kind);
    std::vector<double> value(width);
    const auto evaluate = [&](const FacePoint& p, float* to) {
      surface.evaluate(p.square, p.s, p.t, value.data());
      for (const double v : value) *to++ = static_cast<float>(v);
    };
    for (std::size_t c = 0; c < controls.size(); ++c) {
      surface.set_values(controls[c], width);
      write_corners(squares, width, evaluate, out[c] + 3 * std::size_t(width) * first_triangle_[i]);
    }
  });
}

std::vector<Vec3f> RefinedMesh::normals(const Vec3f* positions) const {
  std::vector<Vec3f> out(creased_ ? 3 * triangles_.size() : point_count_);
  const auto normal = [](const FaceSurface& surface, const FacePoint& p) {
    const LimitPoint limit = surface.evaluate(p.square, p.s, p.t);
    return Vec3f(normalize(cross(limit.du, limit.dv)));
  };
  if (!creased_) {
    evaluate_points({}, [&](FaceSurface& surface, const std::vector<FacePoint>& points) {
      surface.set_values(&positions->x, 3);
      for (const FacePoint& p : points) out[point(p.id)] = normal(surface, p);
    });
    return out;
  }
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    FaceSurface surface(*surface_, drawn_[i]);
    surface.set_values(&positions->x, 3);
    write_corners(
        squares, 1, [&](const FacePoint& p, Vec3f* to) { *to = normal(surface, p); },
        out.data() + 3 * std::size_t(first_triangle_[i]));
  });
  return out;
}

std::vector<FacePoint> RefinedMesh::points_of(std::uint32_t face) const {
  std::vector<FacePoint> points = FaceLattices::distinct(lattices_->squares(face));
  for (FacePoint& p : points) p.id = point(p.id);
  return points;
}

// What a face says at each of its points, once.
template <typename Value>
struct RefinedMesh::Said {
  std::vector<std::uint32_t> points;
  std::vector<Value> values;
};

// `at_face(i, squares, out)`, likewise of the i-th of drawn_.
template <typename Value, typename AtFace>
std::vector<RefinedMesh::Said<Value>> RefinedMesh::said_by_faces(const AtFace& at_face) const {
  std::vector<Said<Value>> result(drawn_.size());
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> seen;  // point, and its place in the squares
    for (const SquareLattice& square : squares) {
      for (const FacePoint& p : square.points)
        seen.emplace_back(point(p.id), static_cast<std::uint32_t>(seen.size()));
    }
    std::vector<Value> values(seen.size());
    at_face(i, squares, values.data());
    std::ranges::sort(seen);
    for (const auto& [p, place] : seen) {
      if (!result[i].points.empty() && result[i].points.back() == p) continue;
      result[i].points.push_back(p);
      result[i].values.push_back(values[place]);
    }
  });
  return result;
}

std::vector<double> RefinedMesh::means(const FaceValues& at_face) const {
  const auto said = said_by_faces<double>([&](std::size_t i, std::span<const SquareLattice> squares,
                                              double* out) { at_face(drawn_[i], squares, out); });
  std::vector<double> sums(point_count_, 0.0);
  std::vector<std::uint32_t> faces(point_count_, 0);
  for (const Said<double>& face : said) {
    for (std::size_t k = 0; k < face.points.size(); ++k) {
      sums[face.points[k]] += face.values[k];
      ++faces[face.points[k]];
    }
  }
  for (std::size_t p = 0; p < sums.size(); ++p) {
    if (faces[p] > 1) sums[p] /= faces[p];
  }
  return sums;
}

RefinedMesh::LimitPoints RefinedMesh::limit(const Vec3f* positions) const {
  struct Here {
    Vec3d position, normal;
  };
  const auto said =
      said_by_faces<Here>([&](std::size_t i, std::span<const SquareLattice> squares, Here* here) {
        FaceSurface surface(*surface_, drawn_[i]);
        surface.set_values(&positions->x, 3);
        for (const SquareLattice& square : squares) {
          for (const FacePoint& p : square.points) {
            const LimitPoint limit = surface.evaluate(p.square, p.s, p.t);
            *here++ = {limit.position, normalize(cross(limit.du, limit.dv))};
          }
        }
      });
  LimitPoints out{std::vector<Vec3d>(point_count_), std::vector<Vec3d>(point_count_)};
  std::vector<bool> placed(point_count_, false);
  for (const Said<Here>& face : said) {
    for (std::size_t k = 0; k < face.points.size(); ++k) {
      const std::uint32_t p = face.points[k];
      if (!placed[p]) out.positions[p] = face.values[k].position;  // as at_points(): the first face's
      placed[p] = true;
      out.normals[p] += face.values[k].normal;
    }
  }
  for (Vec3d& normal : out.normals) normal = normalize(normal);
  return out;
}

GridLayout RefinedMesh::grid_layout() const {
  GridLayout layout;
  std::uint32_t quads = 0;
  for (const std::uint32_t face : drawn_) {
    const std::vector<SquareLattice> squares = lattices_->squares(face);
    for (std::uint32_t s = 0; s < squares.size(); ++s) {
      layout.grids.push_back({face, s, squares[s].columns, squares[s].rows, quads, 3 * layout.points.size()});
      quads += squares[s].columns * squares[s].rows;
      for (const FacePoint& p : squares[s].points) layout.points.push_back(point(p.id));
    }
  }
  return layout;
}

void RefinedMesh::at_grid_points(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                                 std::span<float* const> out) const {
  std::vector<std::size_t> first{0};
  for (const std::uint32_t face : drawn_) {
    std::size_t points = 0;
    for (const SquareLattice& square : lattices_->squares(face)) points += square.points.size();
    first.push_back(first.back() + points);
  }
  for_faces([&](std::size_t i, const std::vector<SquareLattice>& squares) {
    FaceSurface surface(*surface_, drawn_[i], kind);
    std::vector<double> value(width);
    for (std::size_t c = 0; c < controls.size(); ++c) {
      surface.set_values(controls[c], width);
      float* to = out[c] + width * first[i];
      for (const SquareLattice& square : squares) {
        for (const FacePoint& p : square.points) {
          surface.evaluate(p.square, p.s, p.t, value.data());
          for (const double v : value) *to++ = static_cast<float>(v);
        }
      }
    }
  });
}

}  // namespace msbvh
