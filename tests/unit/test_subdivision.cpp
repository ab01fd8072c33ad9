// Limit points against Catmull-Clark written out from its rules, and against closed forms; grids without
// cracks.
#include <algorithm>
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/geometry/subdivision/dice.h"
#include "tests/support/cages.h"
#include "tests/support/catmull_clark.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

// Limit points are rounded to single precision, of coordinates up to about 1.
constexpr double kRounding = 1.5e-7;

double worst_limit(const SubdivisionMesh& cage, int level) {
  CatmullClark truth(cage);
  for (int i = 0; i < level; ++i) truth.refine();
  const auto limits = truth.limits(level);
  const GridMesh grids = dice(cage, {.level = static_cast<std::uint32_t>(level)});
  double worst = 0.0;
  std::size_t compared = 0;
  for (const Grid& g : grids.grids) {
    for (std::uint32_t r = 0; r <= g.rows; ++r) {
      for (std::uint32_t c = 0; c <= g.columns; ++c) {
        const int step = (1 << level) / static_cast<int>(g.columns);
        const auto found = limits.find({g.face, g.square, int(c) * step, int(r) * step});
        REQUIRE(found != limits.end());
        worst = std::max(worst, length(Vec3d(grids.control_point(g, r, c, 0)) - found->second));
        ++compared;
      }
    }
  }
  CHECK(compared == limits.size());
  return worst;
}

SubdivisionMesh creased(SubdivisionMesh cage, std::vector<std::uint32_t> chain, float sharpness) {
  cage.crease_lengths.push_back(static_cast<std::uint32_t>(chain.size()));
  cage.crease_indices.insert(cage.crease_indices.end(), chain.begin(), chain.end());
  cage.crease_sharpnesses.push_back(sharpness);
  return cage;
}

// Directed edges of all triangles with distinct corners, by their positions' bits.
using Point = std::array<float, 3>;
std::map<std::pair<Point, Point>, int> edges_at(const GridMesh& grids, std::uint32_t control) {
  std::map<std::pair<Point, Point>, int> out;
  for (std::uint32_t id = 0; id < grids.triangle_count(); ++id) {
    const GridTriangle t = grids.triangle(id);
    std::array<Point, 3> p;
    for (int i = 0; i < 3; ++i) {
      const GridVertex v = vertices_of(t)[i];
      const Vec3f at = grids.control_point(grids.grids[t.grid], v.row, v.column, control);
      p[i] = {at.x, at.y, at.z};
    }
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    for (int i = 0; i < 3; ++i) ++out[{p[i], p[(i + 1) % 3]}];
  }
  return out;
}

}  // namespace

TEST_CASE("limit points equal Catmull-Clark's own rules") {
  CHECK(worst_limit(cube_cage(), 6) < kRounding);
  CHECK(worst_limit(prism_cage(3), 3) < kRounding);
  CHECK(worst_limit(prism_cage(5), 5) < kRounding);
  CHECK(worst_limit(prism_cage(7), 4) < kRounding);
}

TEST_CASE("boundaries, corners and creases follow their rules") {
  SubdivisionMesh sheet = sheet_cage(4, 3);
  CHECK(worst_limit(sheet, 3) < kRounding);
  sheet.boundary = BoundaryRule::kEdgeOnly;
  CHECK(worst_limit(sheet, 3) < kRounding);
  // A chain across the sheet (side 4: 5 vertices a row), infinitely sharp, then ending inside.
  CHECK(worst_limit(creased(sheet, {10, 11, 12, 13, 14}, 10.0f), 3) < kRounding);
  CHECK(worst_limit(creased(sheet, {10, 11, 12}, 10.0f), 4) < kRounding);
  // Semi-sharp: the sharpness runs down by 1 a level, the fraction blends.
  for (const float sharpness : {0.4f, 1.0f, 1.5f, 2.0f, 2.7f}) {
    CAPTURE(sharpness);
    CHECK(worst_limit(creased(sheet, {10, 11, 12, 13, 14}, sharpness), 4) < kRounding);
    CHECK(worst_limit(creased(cube_cage(), {0, 1, 3, 2, 0}, sharpness), 4) < kRounding);
  }
  sheet.corner_indices = {12};
  sheet.corner_sharpnesses = {10.0f};
  CHECK(worst_limit(sheet, 3) < kRounding);
}

TEST_CASE("a regular face is a bicubic B-spline") {
  const SubdivisionMesh sheet = sheet_cage(3, 8);  // face 4 in the middle sees all 16 vertices
  const GridMesh grids = dice(sheet, {.level = 4});
  const auto basis = [](double t) {
    const double s = 1.0 - t;
    return std::array{s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
                      t * t * t / 6};
  };
  for (std::uint32_t r = 0; r <= 16; ++r) {
    for (std::uint32_t c = 0; c <= 16; ++c) {
      const auto bu = basis(c / 16.0), bv = basis(r / 16.0);
      Vec3d expected;
      for (int i = 0; i < 16; ++i) expected += Vec3d(sheet.positions[i]) * (bu[i % 4] * bv[i / 4]);
      CHECK(length(Vec3d(grids.control_point(grids.grids[4], r, c, 0)) - expected) < kRounding);
    }
  }
}

TEST_CASE("Loop: vertices go to their limit, and one level down again") {
  SubdivisionMesh cage = octahedron_cage();
  cage.scheme = SubdivisionScheme::kLoop;
  const GridMesh grids = dice(cage, {.level = 3});
  CHECK(grids.grids.size() == 24);
  // Loop's mask of valence 4: beta = (5/8 - (3/8)^2) / 4; limit (1 - 4 x) v + x sum, x = 1 / (3 / (8 beta) +
  // 4). The neighbours' sum is 0.
  const double beta = (5.0 / 8 - 9.0 / 64) / 4, x = 1 / (3 / (8 * beta) + 4);
  for (const Grid& g : grids.grids) {
    const Vec3d corner(grids.control_point(g, 0, 0, 0));
    CHECK(length(corner) == doctest::Approx(1 - 4 * x).epsilon(1e-6));
    // The middle of an edge: after one step a regular vertex, (v + sum / 12 ...) in closed form by symmetry.
    const double e = 3.0 / 8 + 1.0 / 8 * 0;  // new vertex of edge x-y: 3/8 (x + y) + 1/8 (z - z)
    const double v = 1 - 4 * beta;           // refined corner; its neighbours cancel
    // Ring: two corners, four edge points (x or y with +-z): their z cancel, x and y share.
    const double near = 0.5 * e + (v + 2 * e) / 12;
    const Vec3d middle(grids.control_point(g, 0, g.columns, 0));
    CHECK(length(middle) == doctest::Approx(near * std::sqrt(2.0)).epsilon(2e-5));
  }
}

TEST_CASE("grids of a closed cage are closed, bit by bit, at every key and at any rates") {
  const auto uneven = [](std::uint32_t a, std::uint32_t b) { return 1 + (a * b + a + b) % 5; };
  for (const SubdivisionMesh& still : {cube_cage(), prism_cage(3), prism_cage(6), octahedron_cage()}) {
    for (const bool loop : {false, true}) {
      if (loop && still.face_vertex_counts != octahedron_cage().face_vertex_counts) continue;
      SubdivisionMesh cage = moved(still, {2, 1}, rotation({1, 2, 3}, 1.0), {100, -7, 3});
      if (loop) cage.scheme = SubdivisionScheme::kLoop;
      cage = creased(cage, {cage.face_vertex_indices[0], cage.face_vertex_indices[1]}, 3.0f);
      for (const bool same : {true, false}) {
        DiceSettings settings{.level = 3, .displacement = bumps(0.05, 0.7, {100, -7, 3})};
        if (!same) settings.edge_level = uneven;
        const GridMesh grids = dice(cage, settings);
        for (std::uint32_t c = 0; c < 3; ++c) {
          const auto edges = edges_at(grids, c);
          CHECK(edges.size() > 100);
          const auto alone = std::ranges::count_if(edges, [&](const auto& e) {
            return e.second != 1 || !edges.contains({e.first.second, e.first.first});
          });
          CHECK(alone == 0);
        }
      }
    }
  }
}

TEST_CASE("limit points move with the cage, at any degree; displacement is exact at the keys") {
  for (const TrackForm form : {TrackForm{4, 1}, {2, 2}, {1, 3}}) {
    const SubdivisionMesh cage = moved(prism_cage(5), form, wave(0.3, 1.5));
    const GridMesh grids = dice(cage, {.level = 2});
    for (const float u : {0.0f, 0.25f, 0.6f, 1.0f}) {
      SubdivisionMesh frozen = cage;  // the cage at u, still
      frozen.segments = 0;
      frozen.degree = 1;
      frozen.positions.clear();
      for (std::uint32_t v = 0; v < cage.vertex_count; ++v) {
        const SegmentTime at = locate(u, form.segments);
        frozen.positions.push_back(bezier(
            [&](std::uint32_t i) {
              return cage.positions[(at.key * form.degree + i) * cage.vertex_count + v];
            },
            form.degree, at.w));
      }
      const GridMesh there = dice(frozen, {.level = 2});
      for (std::uint32_t g = 0; g < grids.grids.size(); ++g) {
        const Grid &a = grids.grids[g], &b = there.grids[g];
        CHECK(length(grids.point(a, 1, 0, u) - there.point(b, 1, 0, u)) < 1e-6f);
      }
    }
  }
  const SubdivisionMesh cage = moved(cube_cage(), {2, 1}, rotation({0, 0, 1}, 1.0));
  const GridMesh flat = dice(cage, {.level = 3});
  const GridMesh raised = dice(cage, {.level = 3, .displacement = [](const SurfacePoint&) { return 0.25; }});
  for (std::uint32_t c = 0; c < 3; ++c) {
    for (std::uint32_t i = 0; i <= 8; ++i) {
      const Vec3f p = flat.control_point(flat.grids[0], i, 3, c),
                  q = raised.control_point(raised.grids[0], i, 3, c);
      CHECK(length(q - p) == doctest::Approx(0.25).epsilon(1e-5));
      CHECK(length(q) > length(p));  // outwards
    }
  }
}

TEST_CASE("handedness turns normals and windings; holes and bare boundaries have no grids") {
  SubdivisionMesh cage = cube_cage();
  const auto raise = [](const SurfacePoint&) { return 0.1; };
  const GridMesh out = dice(cage, {.level = 1, .displacement = raise});
  cage.left_handed = true;
  const GridMesh in = dice(cage, {.level = 1, .displacement = raise});
  CHECK(length(in.control_point(in.grids[0], 1, 1, 0)) < length(out.control_point(out.grids[0], 1, 1, 0)));
  cage.holes = {1, 4};
  CHECK(dice(cage, {.level = 1}).grids.size() == 4);
  SubdivisionMesh sheet = sheet_cage(3, 1);
  sheet.boundary = BoundaryRule::kNone;
  const GridMesh middle = dice(sheet, {.level = 2});
  REQUIRE(middle.grids.size() == 1);
  CHECK(middle.grids[0].face == 4);
}

TEST_CASE("patches tile the grids, and their boxes hold them in flight") {
  const SubdivisionMesh cage = moved(prism_cage(5), {4, 1}, rotation({1, 1, 0}, 2.0));
  const auto rate = [](std::uint32_t a, std::uint32_t b) { return 1 + (a + b) % 5; };
  const GridMesh grids = dice(cage, {.edge_level = rate, .displacement = bumps(0.1, 0.5)});
  std::uint64_t quads = 0;
  for (const GridPatch& p : grids.patches) {
    CHECK(p.rows >= 1);
    CHECK(p.rows <= kPatchQuads);
    quads += p.rows * p.columns;
    const Grid& grid = grids.grids[p.grid];
    for (int i = 0; i <= 40; ++i) {
      const float u = float(i) / 40.0f;
      const SegmentTime at = locate(u, grids.segments);
      const Box3f box = lerp(grids.bounds(p, at.key), grids.bounds(p, at.key + 1), at.w);
      for (std::uint32_t r = 0; r <= p.rows; ++r) {
        for (std::uint32_t c = 0; c <= p.columns; ++c)
          CHECK(box.contains(grids.point(grid, p.row + r, p.column + c, u)));
      }
    }
  }
  CHECK(quads == grids.quad_count);
  for (std::uint32_t id = 0; id < grids.triangle_count(); ++id)
    CHECK(grids.triangle_id(grids.triangle(id)) == id);
}

TEST_CASE("the same grids for any number of threads") {
  const SubdivisionMesh cage = moved(prism_cage(40), {1, 1}, translation({1, 0, 0}));
  const auto values = [&](unsigned threads) {
    std::vector<float> out;
    Arena(threads).execute([&] { out = dice(cage, {.level = 3, .displacement = bumps(0.1, 0.5)}).values; });
    return out;
  };
  CHECK(values(1) == values(2));
}

TEST_CASE("what is wrong with a cage is named") {
  const auto message = [](const SubdivisionMesh& cage, const DiceSettings& settings) {
    try {
      dice(cage, settings);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  SubdivisionMesh bad = cube_cage();
  bad.face_vertex_indices[5] = 99;
  CHECK(message(bad, {}) == "cage: faceVertexIndices: element 5 is 99; expected less than 8");
  bad = cube_cage();
  bad.scheme = SubdivisionScheme::kLoop;
  CHECK(message(bad, {}).find("face 0 has 4 vertices; expected 3") != std::string::npos);
  bad = moved(cube_cage(), {1, 2}, translation({1, 0, 0}));
  const auto bump = [](const SurfacePoint&) { return 1.0; };
  CHECK(message(bad, {.displacement = bump}) == "cage: displacement on a track of degree 2; expected 1");
  const auto nowhere = [](const SurfacePoint&) { return std::nan(""); };
  CHECK(message(cube_cage(), {.displacement = nowhere}).find("not a finite number") != std::string::npos);
  CHECK(message(cube_cage(), {.level = 11}).find("expected 0 to 10") != std::string::npos);
  bad = creased(cube_cage(), {0, 1}, -1.0f);
  CHECK(message(bad, {}).find("negative") != std::string::npos);
}
