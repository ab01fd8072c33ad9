#include "tests/fuzz/fuzzed_shapes.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace msbvh::fuzz {
namespace {

// Controls that arrays are made for, whatever a broken form says.
std::uint32_t controls_of(const TrackForm& form) { return is_valid_form(form) ? form.controls() : 2; }

// Tests of curves have the fourth power of coordinates in them, which overflows far below kMaxCoordinate.
constexpr float kMostRound = 0x1p24f;

// Radii: some of them 0, some as large as the set is. `alike`: of one control, all the same. Tubes whose
// radius changes by more than they are long are drawn as their ends' balls alone.
std::vector<RoundVertex> round_vertices(FuzzedData& data, std::size_t count, std::size_t alike = 1) {
  std::vector<Vec3f> places = data.points(count);
  if (!data.broken()) {
    const Vec3f most{kMostRound, kMostRound, kMostRound};
    for (Vec3f& p : places) p = min(max(p, -most), most);
  }
  double reach = 0.0;
  for (std::size_t i = 1; i < count; ++i) {
    const Vec3f d = abs(places[i] - places[0]);
    if (is_finite(d)) reach = std::max({reach, double(d.x), double(d.y), double(d.z)});
  }
  const double widest = std::min(0x1p59, reach) * data.one_of({0.01, 0.03, 0.0, 1e-6, 1e-3});
  const std::vector<float> radii = data.reals(count / alike + 1, 0.0f, float(widest));
  std::vector<RoundVertex> vertices(count);
  for (std::size_t i = 0; i < count; ++i) vertices[i] = {places[i], radii[i / alike]};
  return vertices;
}

}  // namespace

TrackForm fuzzed_form(FuzzedData& data) {
  TrackForm form;
  form.segments = data.rarely() ? kMaxSegments : data.one_of({0u, 1u, 2u, 4u, 8u, 16u, 1u, 2u});
  if (form.moving()) form.degree = 1 + data.below(3);
  if (data.wrong()) form.segments = data.one_of({3u, 256u, 0xffffffffu, 0x80000000u});
  if (data.wrong()) form.degree = data.one_of({0u, 4u, 2u, 0xffffffffu});
  return form;
}

std::uint32_t fuzzed_count(FuzzedData& data, const TrackForm& form, std::uint32_t most) {
  return std::min(data.below(most + 1), std::max(3u, kMostValues / controls_of(form)));
}

TimeRemap fuzzed_time_remap(FuzzedData& data) {
  TimeRemap remap;
  const std::uint32_t count = data.coin() ? 0 : data.below(5);
  float begin = 0.0f;
  for (std::uint32_t i = 0; i < count && begin <= 1.0f; ++i) {
    TimeRemapPiece piece{begin, float(data.unit()), float(data.unit()), !data.rarely()};
    if (piece.from > piece.to && !data.wrong()) std::swap(piece.from, piece.to);
    if (data.wrong()) piece.from = data.real32();
    remap.pieces.push_back(piece);
    begin += std::max(1e-7f, float(data.unit()) * 0.5f);
    if (data.wrong()) begin = data.real32();
  }
  return remap;
}

bool stays_in_reach(const Bvh& object, std::span<const Affine3f> world_from_object) {
  double farthest = 0.0, largest = 0.0, offset = 0.0;
  const auto grow = [](double& most, const Vec3f& v) {
    most = std::max({most, std::abs(double(v.x)), std::abs(double(v.y)), std::abs(double(v.z))});
  };
  for (const Box3f& box : object.root_bounds) {
    grow(farthest, box.lo);
    grow(farthest, box.hi);
  }
  for (const Affine3f& m : world_from_object) {
    for (const Vec3f& column : {m.x, m.y, m.z}) grow(largest, column);
    grow(offset, m.t);
  }
  return 3.0 * largest * farthest + offset <= double(kMaxCoordinate);
}

TriangleMesh fuzzed_mesh(FuzzedData& data, const TriangleMesh* topology) {
  TriangleMesh mesh;
  mesh.name = "/mesh";
  const TrackForm form = fuzzed_form(data);
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  if (topology) {
    mesh.vertex_count = topology->vertex_count;
    mesh.triangles = topology->triangles;
  } else {
    mesh.vertex_count = fuzzed_count(data, form, 60);
    const std::uint32_t triangles = mesh.vertex_count == 0 ? 0 : data.below(48);
    const std::vector<std::uint32_t> corners = data.indices(3 * triangles, mesh.vertex_count);
    for (std::uint32_t t = 0; t < triangles; ++t)
      mesh.triangles.push_back({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
  }
  mesh.positions =
      data.points(std::size_t(controls_of(form)) * mesh.vertex_count + (data.wrong() ? data.below(5) : 0));
  if (data.coin()) mesh.positions.resize(mesh.positions.size() + TriangleMesh::kGuard);
  return mesh;
}

GridMesh fuzzed_grids(FuzzedData& data, const GridMesh* topology) {
  GridMesh mesh;
  mesh.name = "/grids";
  const TrackForm form = fuzzed_form(data);
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  const std::uint32_t side = controls_of(form) > 33 ? 2 : controls_of(form) > 5 ? 3 : 9;
  const std::size_t count = topology ? topology->grids.size() : 1 + data.below(2);
  std::size_t values = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Grid grid = topology ? topology->grids[i]
                         : Grid{std::uint32_t(i), 0, 1 + data.below(side), 1 + data.below(side), 0, 0};
    if (data.wrong()) grid.rows = data.one_of({0u, kMaxGridQuads + 1, 0xffffffffu});
    grid.first_value = values;
    if (grid.rows < 1000) values += 3 * std::size_t(controls_of(form)) * grid.points();
    mesh.grids.push_back(grid);
  }
  const bool sound = std::ranges::all_of(mesh.grids, [](const Grid& g) { return g.rows < 1000; });
  if (sound) cut_into_patches(mesh);
  if (!mesh.patches.empty() && data.wrong()) mesh.patches.pop_back();
  if (data.wrong()) mesh.grids.front().first_value = data.number32();
  const std::vector<Vec3f> points = data.points(values / 3);
  for (const Vec3f& p : points) mesh.values.insert(mesh.values.end(), {p.x, p.y, p.z});
  mesh.values.resize(mesh.values.size() + (data.wrong() ? data.below(8) : GridMesh::kGuard));
  return mesh;
}

CurveSet fuzzed_curves(FuzzedData& data, const CurveSet* topology) {
  CurveSet curves;
  curves.name = "/curves";
  const TrackForm form = fuzzed_form(data);
  curves.segments = form.segments;
  curves.degree = form.degree;
  curves.shape = data.one_of({CurveShape::kRibbon, CurveShape::kOriented, CurveShape::kTube});
  if (topology) {
    curves.vertex_count = topology->vertex_count;
    curves.spans = topology->spans;
  } else {
    const std::uint32_t spans = 1 + data.below(4);
    for (std::uint32_t i = 0, first = 0; i < spans; ++i) {
      curves.spans.push_back(first);
      first += data.coin() ? kSpanVertices - 1 : kSpanVertices + data.below(2);
      curves.vertex_count = curves.spans.back() + kSpanVertices + data.below(2);
    }
    if (data.wrong()) curves.spans[data.below(spans)] = data.one_of({0xffffffffu, curves.vertex_count, 1u});
    if (data.wrong()) curves.loops.push_back({data.below(spans), data.one_of({spans, 0u, 0xffffffffu})});
  }
  const std::size_t values = std::size_t(controls_of(form)) * curves.vertex_count;
  const bool tube = curves.shape == CurveShape::kTube;
  curves.vertices = round_vertices(data, values + (data.wrong() ? 1 : 0), tube ? curves.vertex_count : 1);
  if (curves.shape == CurveShape::kOriented || data.wrong()) curves.normals = data.points(values);
  return curves;
}

PointSet fuzzed_points(FuzzedData& data, const PointSet* topology) {
  PointSet points;
  points.name = "/points";
  const TrackForm form = fuzzed_form(data);
  points.segments = form.segments;
  points.degree = form.degree;
  points.point_count = topology ? topology->point_count : fuzzed_count(data, form, 20);
  points.vertices =
      round_vertices(data, std::size_t(controls_of(form)) * points.point_count + (data.wrong() ? 1 : 0));
  return points;
}

}  // namespace msbvh::fuzz
