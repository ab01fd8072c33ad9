// Subdivision cages, refined to triangles and diced to displaced grids: what the gate lets pass comes out
// finite, and as a tree that holds its invariants.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/api/accel.h"
#include "core/geometry/subdivision/dice.h"
#include "core/geometry/subdivision/refined_mesh.h"
#include "core/geometry/subdivision/subdivision_mesh.h"
#include "tests/fuzz/checks.h"
#include "tests/fuzz/fuzzed_shapes.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;

namespace {

constexpr std::uint32_t kMostLevel = 3;
constexpr std::uint64_t kMostPoints = 20'000;

// Faces: sheets of quads and strips, which neighbours share edges in, or any vertices.
void add_faces(SubdivisionMesh& mesh, FuzzedData& data) {
  const std::uint32_t columns = 1 + data.below(4), rows = 1 + data.below(3);
  if (data.coin()) {
    mesh.vertex_count = (columns + 1) * (rows + 1);
    for (std::uint32_t r = 0; r < rows; ++r) {
      for (std::uint32_t c = 0; c < columns; ++c) {
        const std::uint32_t a = r * (columns + 1) + c, b = a + columns + 1;
        if (data.rarely()) {
          mesh.face_vertex_counts.insert(mesh.face_vertex_counts.end(), {3, 3});
          mesh.face_vertex_indices.insert(mesh.face_vertex_indices.end(), {a, a + 1, b + 1, a, b + 1, b});
        } else {
          mesh.face_vertex_counts.push_back(4);
          mesh.face_vertex_indices.insert(mesh.face_vertex_indices.end(), {a, a + 1, b + 1, b});
        }
      }
    }
  } else {
    mesh.vertex_count = data.below(20);
    for (std::uint32_t n = data.below(12); n > 0; --n) {
      const std::uint32_t count = data.rarely() ? data.below(9) : 3 + data.below(2);
      mesh.face_vertex_counts.push_back(count);
      const auto corners = data.indices(count, mesh.vertex_count);
      mesh.face_vertex_indices.insert(mesh.face_vertex_indices.end(), corners.begin(), corners.end());
    }
  }
  if (data.wrong() && !mesh.face_vertex_counts.empty()) {
    mesh.face_vertex_counts[0] = data.one_of({0u, 1u, 2u, 5u, 0xffffffffu, 0x7fffffffu});
  }
  if (data.wrong() && !mesh.face_vertex_indices.empty()) mesh.face_vertex_indices.pop_back();
}

void add_creases(SubdivisionMesh& mesh, FuzzedData& data) {
  const auto faces = std::uint32_t(mesh.face_vertex_counts.size());
  if (data.rarely()) mesh.holes = data.indices(1 + data.below(2), faces);
  for (std::uint32_t n = data.below(3); n > 0; --n) {
    const std::uint32_t length = data.wrong() ? data.below(3) : 2 + data.below(3);
    mesh.crease_lengths.push_back(length);
    const auto chain = data.indices(length, mesh.vertex_count);
    mesh.crease_indices.insert(mesh.crease_indices.end(), chain.begin(), chain.end());
  }
  const bool each_edge = data.coin();
  std::size_t edges = 0;
  for (const std::uint32_t length : mesh.crease_lengths) edges += each_edge ? std::max(1u, length) - 1 : 1;
  mesh.crease_sharpnesses = data.reals(edges + (data.wrong() ? 1 : 0), 0.0f, 12.0f);
  const std::uint32_t corners = data.below(3);
  mesh.corner_indices = data.indices(corners, mesh.vertex_count);
  mesh.corner_sharpnesses = data.reals(corners + (data.wrong() ? 1 : 0), 0.0f, 12.0f);
}

SubdivisionMesh fuzzed_cage(FuzzedData& data) {
  SubdivisionMesh mesh;
  mesh.name = "/cage";
  mesh.scheme =
      data.one_of({SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop, SubdivisionScheme::kBilinear});
  mesh.boundary = BoundaryRule(data.below(3));
  mesh.triangle_rule = TriangleRule(data.below(2));
  mesh.face_varying_rule = FaceVaryingRule(data.below(6));
  mesh.left_handed = data.coin();
  add_faces(mesh, data);
  add_creases(mesh, data);
  if (data.coin()) {
    FaceVaryingTopology& channel = mesh.face_varying.emplace_back();
    channel.value_count = 1 + data.below(12);
    channel.indices =
        data.indices(mesh.face_vertex_indices.size() + (data.wrong() ? 1 : 0), channel.value_count);
  }
  const TrackForm form = data.coin() ? TrackForm{} : TrackForm{data.one_of({1u, 2u, 4u}), 1 + data.below(3)};
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  if (data.wrong()) mesh.degree = data.one_of({0u, 4u});
  mesh.positions = data.points(std::size_t(form.controls()) * mesh.vertex_count + (data.wrong() ? 1 : 0));
  return mesh;
}

template <typename Values>
void require_finite(const Values& values, const char* what) {
  for (const auto& value : values) {
    if constexpr (requires { value.x; }) {
      require(is_finite(value), what);
    } else {
      require(std::isfinite(value), what);
    }
  }
}

// Triangles between limit points, and all that is evaluated on them.
void refine(const SubdivisionMesh& mesh, FuzzedData& data) {
  const std::uint32_t a = data.below(kMostLevel + 1), b = data.below(kMostLevel + 1);
  const auto level = [&](const CageEdge& edge) { return (edge.a + edge.b) % 2 == 0 ? a : b; };
  const Vec3f* first = mesh.control_positions(0);
  const auto refined = accepted([&] { return RefinedMesh(mesh, std::span(&first, 1), level, kMostPoints); });
  if (!refined) return;
  std::vector<float> points(3 * std::size_t(refined->point_count()));
  const float* in = &first->x;
  float* out = points.data();
  refined->at_points(ValueKind{}, 3, std::span(&in, 1), std::span(&out, 1));
  require_finite(points, "a limit point that is not finite");
  require_finite(refined->normals(first), "a normal that is not finite");
  const RefinedMesh::LimitPoints limit = refined->limit(first);
  require_finite(limit.positions, "a limit position that is not finite");
  require_finite(limit.normals, "a limit normal that is not finite");
  const GridLayout layout = refined->grid_layout();
  for (const std::uint32_t point : layout.points)
    require(point < refined->point_count(), "a grid's point that there is not");

  TriangleMesh triangles;
  triangles.name = "/refined";
  triangles.vertex_count = refined->point_count();
  triangles.triangles = refined->triangles();
  for (std::size_t i = 0; i < points.size(); i += 3)
    triangles.positions.push_back({points[i], points[i + 1], points[i + 2]});
  Accel accel;
  // Between coordinates of 2^60, limit points may lie beyond.
  if (!passes([&] { accel.add_mesh(std::move(triangles)); })) return;
  accel.commit();
  check_tree(accel, data, 2);
}

// Grids displaced along their normals.
void displace(const SubdivisionMesh& mesh, FuzzedData& data) {
  DiceSettings settings;
  settings.level = data.below(kMostLevel + 1);
  const std::uint32_t other = data.below(kMostLevel + 1);
  if (data.coin())
    settings.edge_level = [=](std::uint32_t a, std::uint32_t b) { return (a + b) % 3 == 0 ? other : 1u; };
  const double height = data.real();
  if (data.coin())
    settings.displacement = [=](const SurfacePoint& p) { return height * std::sin(p.position.x); };
  const auto grids = accepted([&] { return dice(mesh, settings); });
  if (!grids) return;
  Accel accel;
  if (!passes([&] { accel.add_grids(*grids); })) return;
  accel.commit();
  check_tree(accel, data, 2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  const SubdivisionMesh mesh = fuzzed_cage(data);
  if (!passes([&] { validate(mesh); })) return 0;
  if (data.coin()) {
    refine(mesh, data);
  } else {
    displace(mesh, data);
  }
  return 0;
}
