#include "core/geometry/subdivision/dice.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/geometry/subdivision/face_lattice.h"
#include "core/geometry/subdivision/limit_surface.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {
namespace {

constexpr std::size_t kFacesPerTask = 16;
constexpr std::size_t kPointsPerTask = 4096;
constexpr std::uint32_t kNobody = 0xffffffffu;

std::uint32_t level_of_edge(const DiceSettings& settings, std::uint32_t a, std::uint32_t b) {
  return settings.edge_level ? settings.edge_level(a, b) : settings.level;
}

std::uint32_t finest_level(const SubdivisionMesh& mesh, const DiceSettings& settings) {
  std::uint32_t finest = settings.edge_level ? 1 : settings.level;
  const auto* v = mesh.face_vertex_indices.data();
  for (std::size_t f = 0; settings.edge_level && f < mesh.face_vertex_counts.size(); ++f) {
    const std::uint32_t n = mesh.face_vertex_counts[f];
    for (std::uint32_t i = 0; i < n; ++i)
      finest = std::max(finest, settings.edge_level(v[i], v[(i + 1) % n]));
    v += n;
  }
  return std::min(finest, kMaxEdgeLevel);  // more is an error of FaceLattices'
}

std::vector<std::uint32_t> edge_levels(const LimitSurface& surface, const DiceSettings& settings) {
  std::vector<std::uint32_t> levels(surface.edge_count(), 1);
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto v = surface.face_vertices(f);
    for (std::size_t i = 0; i < v.size(); ++i) {
      levels[static_cast<std::size_t>(surface.face_edges(f)[i])] = level_of_edge(
          settings, static_cast<std::uint32_t>(v[i]), static_cast<std::uint32_t>(v[(i + 1) % v.size()]));
    }
  }
  return levels;
}

class Dicer {
 public:
  Dicer(const SubdivisionMesh& mesh, const DiceSettings& settings)
      : mesh_(mesh),
        settings_(settings),
        surface_(mesh, finest_level(mesh, settings)),
        lattices_(surface_, edge_levels(surface_, settings)),
        controls_(mesh.form().controls()),
        owner_(lattices_.point_count(), kNobody),
        positions_(std::size_t(controls_) * lattices_.point_count()) {}

  GridMesh run() {
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (surface_.has_limit(f)) faces_.push_back(f);
    }
    points_.resize(faces_.size());
    normals_.resize(faces_.size());
    for_faces([&](std::size_t i) { points_[i] = FaceLattices::distinct(lattices_.squares(faces_[i])); });
    // A point belongs to the first face that sees it, and has that face's position: one, bit for bit.
    for (std::uint32_t i = 0; i < faces_.size(); ++i) {
      for (const FacePoint& p : points_[i]) owner_[p.id] = std::min(owner_[p.id], i);
    }
    for_faces([&](std::size_t i) { evaluate(i); });
    if (settings_.displacement) displace();
    return assemble();
  }

 private:
  void for_faces(const std::function<void(std::size_t)>& body) {
    parallel_for_ranges(faces_.size(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }
  std::size_t at(std::uint32_t control, std::uint32_t id) const {
    return std::size_t(control) * lattices_.point_count() + id;
  }

  void evaluate(std::size_t i) {
    FaceSurface face(surface_, faces_[i]);
    for (std::uint32_t c = 0; c < controls_; ++c) {
      face.set_values(&mesh_.control_positions(c)->x, 3);
      for (const FacePoint& p : points_[i]) {
        if (!settings_.displacement && owner_[p.id] != i) continue;
        const LimitPoint limit = face.evaluate(p.square, p.s, p.t);
        if (owner_[p.id] == i) positions_[at(c, p.id)] = limit.position;
        if (settings_.displacement) normals_[i].push_back(normalize(cross(limit.du, limit.dv)));
      }
    }
  }

  // Normals are added up in the order of the faces, whatever the number of threads.
  void displace() {
    std::vector<Vec3d> sums(positions_.size());
    parallel_for(controls_, [&](std::size_t control) {
      const auto c = static_cast<std::uint32_t>(control);
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        const std::size_t count = points_[i].size();
        for (std::size_t k = 0; k < count; ++k)
          sums[at(c, points_[i][k].id)] += normals_[i][control * count + k];
      }
    });
    for_faces([&](std::size_t i) {
      for (std::uint32_t c = 0; c < controls_; ++c) {
        for (const FacePoint& p : points_[i]) {
          if (owner_[p.id] == i) displace(faces_[i], p, c, normalize(sums[at(c, p.id)]));
        }
      }
    });
  }

  void displace(std::uint32_t face, const FacePoint& p, std::uint32_t control, const Vec3d& normal) {
    Vec3d& position = positions_[at(control, p.id)];
    const SurfacePoint where{face, p.square, p.s, p.t, control, position, normal};
    position += normal * settings_.displacement(where);
    const Vec3d size = abs(position);
    if (size.x <= kMaxCoordinate && size.y <= kMaxCoordinate && size.z <= kMaxCoordinate) return;
    throw Error((mesh_.name.empty() ? std::string("mesh") : mesh_.name) + ": displacement: face " +
                std::to_string(face) +
                " is displaced to a coordinate that is not a finite number of at most 2^60 in size");
  }

  GridMesh assemble() {
    GridMesh out{mesh_.name, mesh_.segments, mesh_.degree, {}, {}, 0, {}};
    std::size_t values = 0;
    std::vector<std::size_t> first_grid;
    for (const std::uint32_t f : faces_) {
      first_grid.push_back(out.grids.size());
      const std::vector<SquareLattice> squares = lattices_.squares(f);
      for (std::uint32_t s = 0; s < squares.size(); ++s) {
        out.grids.push_back({f, s, squares[s].columns, squares[s].rows, 0, values});
        values += 3 * std::size_t(controls_) * out.grids.back().points();
      }
    }
    out.values.resize(values + GridMesh::kGuard);
    for_faces([&](std::size_t i) {
      const std::vector<SquareLattice> squares = lattices_.squares(faces_[i]);
      for (std::size_t s = 0; s < squares.size(); ++s)
        write(squares[s], out.grids[first_grid[i] + s], out.values);
    });
    cut_into_patches(out);
    return out;
  }

  void write(const SquareLattice& square, const Grid& grid, std::vector<float>& values) const {
    float* to = values.data() + grid.first_value;
    for (std::uint32_t c = 0; c < controls_; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const FacePoint& p : square.points) *to++ = static_cast<float>(positions_[at(c, p.id)][axis]);
      }
    }
  }

  const SubdivisionMesh& mesh_;
  const DiceSettings& settings_;
  LimitSurface surface_;
  FaceLattices lattices_;
  std::uint32_t controls_;
  std::vector<std::uint32_t> faces_;            // those with a limit
  std::vector<std::vector<FacePoint>> points_;  // of each of faces_
  std::vector<std::vector<Vec3d>> normals_;     // [faces_][control][point]
  std::vector<std::uint32_t> owner_;            // by point, an index into faces_
  std::vector<Vec3d> positions_;                // [control][point]
};

}  // namespace

GridMesh dice(const SubdivisionMesh& mesh, const DiceSettings& settings) {
  validate(mesh);
  if (settings.displacement && mesh.degree != 1) {
    throw Error((mesh.name.empty() ? std::string("mesh") : mesh.name) +
                ": displacement on a track of degree " + std::to_string(mesh.degree) + "; expected 1");
  }
  return Dicer(mesh, settings).run();
}

}  // namespace msbvh
