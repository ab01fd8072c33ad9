#include "delegate/translate/displace/distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/base/lerp.h"
#include "delegate/translate/displace/face_primvar.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

using St = std::array<double, 2>;

// The primvars that the displacements of a mesh read, as they are at a time.
class DistanceReader {
 public:
  DistanceReader(const Tessellation& mesh, const FaceDisplacements& displacements, double time01,
                 double frame01, PrimLog& log)
      : displacements_(displacements) {
    for (const Displacement* d : displacements.used()) {
      const NamedPrimvar* named = displacements.primvar(d->needed_primvar());
      if (!named || primvars_.contains(named->name)) continue;
      // Where a texture is read stays as it is at the frame.
      const double time = d->texture ? frame01 : time01;
      if (auto primvar = FacePrimvar::at(*named, time, mesh, log)) primvars_.emplace(named->name, *primvar);
    }
  }

  void at_squares(std::uint32_t cage_face, std::uint32_t face, std::span<const SquareLattice> squares,
                  double* out) const;
  // Of a polygon's corner; `neighbours`: those before and after it.
  struct Corner {
    std::uint32_t corner, point;
  };
  double at_corner(std::uint32_t face, const Corner& here, const std::array<Corner, 2>& neighbours) const;

 private:
  const FacePrimvar* primvar(const Displacement& d) const {
    const auto found = primvars_.find(d.needed_primvar());
    return found == primvars_.end() ? nullptr : &found->second;
  }
  static double textured(const Displacement& d, const St& st, const St& size) {
    return d.texture->at(st[0], st[1], size[0], size[1]) * d.scale + d.bias;
  }

  const FaceDisplacements& displacements_;
  std::map<std::string, FacePrimvar> primvars_;
};

void grow(St& size, const St& from, const St& to) {
  for (int i = 0; i < 2; ++i) size[i] = std::max(size[i], std::abs(to[i] - from[i]));
}

// The largest steps to the neighbours of a lattice's point.
St step_around(const SquareLattice& square, const St* values, std::uint32_t r, std::uint32_t c) {
  const std::uint32_t stride = square.columns + 1;
  const St& here = values[r * stride + c];
  St size{};
  if (c > 0) grow(size, here, values[r * stride + c - 1]);
  if (c < square.columns) grow(size, here, values[r * stride + c + 1]);
  if (r > 0) grow(size, here, values[(r - 1) * stride + c]);
  if (r < square.rows) grow(size, here, values[(r + 1) * stride + c]);
  return size;
}

void DistanceReader::at_squares(std::uint32_t cage_face, std::uint32_t face,
                                std::span<const SquareLattice> squares, double* out) const {
  std::size_t count = 0;
  for (const SquareLattice& square : squares) count += square.points.size();
  const Displacement* found = displacements_.of_face(face);
  if (!found) {
    std::fill_n(out, count, 0.0);
    return;
  }
  const Displacement& d = *found;
  const FacePrimvar* read = primvar(d);
  if (!read && !d.texture) {
    std::fill_n(out, count, d.constant);
    return;
  }
  const St fallback = d.coordinates.fallback;
  std::vector<Vec3d> values(count, Vec3d{fallback[0], fallback[1], 0.0});
  if (read) read->at_squares(cage_face, face, squares, values.data());
  if (!d.texture) {
    for (const Vec3d& value : values) *out++ = value.x;
    return;
  }
  std::vector<St> st;
  for (const Vec3d& value : values) st.push_back(d.coordinates.mapped(value.x, value.y));
  const St* first = st.data();
  for (const SquareLattice& square : squares) {
    for (std::uint32_t r = 0; r <= square.rows; ++r) {
      for (std::uint32_t c = 0; c <= square.columns; ++c)
        *out++ = textured(d, first[r * (square.columns + 1) + c], step_around(square, first, r, c));
    }
    first += square.points.size();
  }
}

double DistanceReader::at_corner(std::uint32_t face, const Corner& here,
                                 const std::array<Corner, 2>& neighbours) const {
  const Displacement* found = displacements_.of_face(face);
  if (!found) return 0.0;
  const Displacement& d = *found;
  const FacePrimvar* read = primvar(d);
  if (!d.texture) return read ? read->at_corner(face, here.corner, here.point).x : d.constant;
  const auto st_at = [&](const Corner& corner) {
    if (!read) return d.coordinates.mapped(d.coordinates.fallback[0], d.coordinates.fallback[1]);
    const Vec3d value = read->at_corner(face, corner.corner, corner.point);
    return d.coordinates.mapped(value.x, value.y);
  };
  const St st = st_at(here);
  St size{};
  for (const Corner& neighbour : neighbours) grow(size, st, st_at(neighbour));
  return textured(d, st, size);
}

// Of the points of polygons, each the mean of the corners there; faces that are not drawn don't count.
std::vector<double> polygon_distances(const MeshInput& input, const Triangulation& polygons,
                                      const DistanceReader& reader) {
  std::vector<std::uint32_t> first{0};
  for (const int count : input.face_vertex_counts) first.push_back(first.back() + std::uint32_t(count));
  std::vector<double> sums(polygons.point_count, 0.0);
  std::vector<std::uint32_t> corners(polygons.point_count, 0);
  std::vector<bool> seen(polygons.face_vertex_count, false);
  for (std::size_t t = 0; t < polygons.corners.size(); ++t) {
    const std::uint32_t face = polygons.faces[t], begin = first[face], size = first[face + 1] - begin;
    const auto corner_at = [&](std::uint32_t place) {
      const std::uint32_t corner = begin + place % size;
      return DistanceReader::Corner{corner, std::uint32_t(input.face_vertex_indices[corner])};
    };
    for (const std::uint32_t corner : polygons.corners[t]) {
      if (seen[corner]) continue;
      seen[corner] = true;
      const std::uint32_t place = corner - begin;
      const auto here = corner_at(place);
      sums[here.point] += reader.at_corner(face, here, {corner_at(place + size - 1), corner_at(place + 1)});
      ++corners[here.point];
    }
  }
  for (std::size_t p = 0; p < sums.size(); ++p) {
    if (corners[p] > 1) sums[p] /= corners[p];
  }
  return sums;
}

bool changes(const PrimvarInput<Vec3f>& primvar) {
  return std::ranges::any_of(primvar.samples, [&](const PrimvarSample<Vec3f>& sample) {
    return !std::ranges::equal(sample.values, primvar.samples.front().values);
  });
}

// Where distances may change their course.
std::vector<double> times_of(const FaceDisplacements& displacements, PrimLog& log) {
  std::vector<double> times01;
  for (const Displacement* d : displacements.used()) {
    const NamedPrimvar* named = displacements.primvar(d->needed_primvar());
    if (!named || !changes(named->primvar)) continue;
    if (d->texture) {
      log.warn("primvars:" + named->name,
               "changes within the shutter; displaced as the texture lies at the frame");
      continue;
    }
    for (const PrimvarSample<Vec3f>& sample : named->primvar.samples) times01.push_back(sample.time01);
  }
  std::ranges::sort(times01);
  times01.erase(std::unique(times01.begin(), times01.end()), times01.end());
  if (times01.empty()) times01.push_back(0.0);
  return times01;
}

}  // namespace

struct PlaceDistances::Data {
  const Tessellation& mesh;
  DistanceReader reader;
};

PlaceDistances::PlaceDistances(const MeshInput& input, const Tessellation& mesh,
                               const FaceDisplacements& displacements, double time01) {
  std::vector<Diagnostic> unsaid;
  PrimLog log(unsaid, input.path);
  data_ = std::make_unique<Data>(
      Data{mesh, DistanceReader(mesh, displacements, time01, input.time_remap.frame01, log)});
}
PlaceDistances::~PlaceDistances() = default;

void PlaceDistances::at_squares(std::uint32_t cage_face, std::span<const SquareLattice> squares,
                                double* out) const {
  const std::vector<std::uint32_t>& faces = data_->mesh.refinement()->cage_faces;
  data_->reader.at_squares(cage_face, faces.empty() ? cage_face : faces[cage_face], squares, out);
}

PointDistances::PointDistances(std::vector<double> times01, std::vector<std::vector<double>> values)
    : times01_(std::move(times01)), values_(std::move(values)) {}

std::vector<double> PointDistances::at(double time01) const {
  const Bracket place = bracket(times01_, time01, false);
  if (place.w == 0.0) return values_[place.first];
  std::vector<double> result = values_[place.first];
  const std::vector<double>& next = values_[place.second];
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = lerp(result[i], next[i], place.w);
  return result;
}

double PointDistances::largest() const {
  double largest = 0.0;
  for (const std::vector<double>& values : values_) {
    for (const double value : values) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

PointDistances point_distances(const MeshInput& input, const Tessellation& mesh,
                               const FaceDisplacements& displacements, PrimLog& log) {
  std::vector<double> times01 = times_of(displacements, log);
  std::vector<std::vector<double>> values;
  std::vector<Diagnostic> heard_already;
  for (const double time01 : times01) {
    PrimLog repeated(heard_already, log.path());
    const DistanceReader reader(mesh, displacements, time01, input.time_remap.frame01,
                                values.empty() ? log : repeated);
    const Refinement* refinement = mesh.refinement();
    if (!refinement) {
      values.push_back(polygon_distances(input, mesh.polygons(), reader));
      continue;
    }
    const std::vector<std::uint32_t>& faces = refinement->cage_faces;
    values.push_back(refinement->mesh->means(
        [&](std::uint32_t cage_face, std::span<const SquareLattice> squares, double* out) {
          reader.at_squares(cage_face, faces.empty() ? cage_face : faces[cage_face], squares, out);
        }));
  }
  return {std::move(times01), std::move(values)};
}

}  // namespace msbvh::translate
