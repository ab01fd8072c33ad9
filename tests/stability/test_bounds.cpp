// Boxes hold what they bound: at the keys, at the floats beside them and anywhere between, after splits,
// refits and re-braiding, among tracks of different key counts, in either layout. Judged by exact arithmetic
// (tests/stability/box_judge.h): nothing is widened by a tolerance.
#include <array>
#include <doctest/doctest.h>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/shapes.h"
#include "core/base/parallel.h"
#include "core/build/clip.h"
#include "core/bvh/key_bounds.h"
#include "tests/property/support.h"
#include "tests/stability/box_judge.h"
#include "tests/stability/exact_parts.h"
#include "tests/stability/rounded.h"
#include "tests/support/cages.h"
#include "tests/support/soak.h"

using namespace msbvh;
using namespace msbvh::procedural;
using namespace msbvh::stability;

namespace {

const TrackForm kForms[] = {{0, 1}, {1, 1}, {2, 1}, {8, 1}, {128, 1}, {1, 2}, {4, 2}, {1, 3}, {2, 3}};

struct Built {
  Accel accel;
  std::vector<std::shared_ptr<Accel>> objects;  // that its instances show
};

// What a tree is built over, of one form where it is not mixed.
struct Content {
  const char* name;
  std::function<Built(const TrackForm&, const Vec3d& at, const BuildSettings&)> make;
};

Built tree_of(std::vector<TriangleMesh> meshes, const BuildSettings& settings) {
  Built built;
  for (TriangleMesh& mesh : meshes) built.accel.add_mesh(std::move(mesh));
  built.accel.commit(settings);
  return built;
}

TriangleMesh turning_sticks(int count, const TrackForm& form, const Vec3d& at) {
  const double radians = form.segments > 1 ? 2.0 : 0.7;
  return moved(sticks(count, 1), form, rotation({1, 2, 0.5}, radians), at);
}

// Areas of zero at the shutter's centre, where fragments are cut.
Built collapsing(const TrackForm& form, const Vec3d& at, const BuildSettings& settings) {
  const Motion flat = [](const Vec3d& p, double u) {
    const double s = 2.0 * std::abs(u - 0.5);
    return Vec3d{p.x, p.y * s + 1e-7 * p.x, p.z * s};
  };
  return tree_of({moved(sticks(40, 12), form, flat, at)}, settings);
}

Built mixed(const TrackForm& form, const Vec3d& at, const BuildSettings& settings) {
  std::vector<TriangleMesh> meshes{turning_sticks(20, form, at)};
  for (const TrackForm& other : {TrackForm{0, 1}, TrackForm{1, 1}, TrackForm{16, 1}, TrackForm{2, 3}})
    meshes.push_back(moved(sticks(10, 5 + other.segments), other, rotation({0, 1, 1}, 0.9), at));
  return tree_of(std::move(meshes), settings);
}

// The topology of one frame, evaluated at the keys of another.
Built refitted(const TrackForm& form, const Vec3d& at, BuildSettings settings) {
  settings.keep_topology = true;
  settings.refit = Refit::kAlways;
  Built before = tree_of({moved(sticks(40, 1), form, rotation({1, 2, 0.5}, 0.5), at)}, settings), after;
  after.accel.add_mesh(moved(sticks(40, 1), form, rotation({2, 0, 0.5}, 1.0), at + Vec3d{0.3, 0, 0.1}));
  after.accel.commit_from(before.accel, settings);
  return after;
}

TimeRemap halting() {
  return {{{0.0f, 0.0f, 0.3f}, {0.4f, 0.3f, 0.3f}, {0.6f, 0.5f, 1.0f}, {0.9f, 0.0f, 0.0f, false}}};
}

Built instanced(const TrackForm& form, const Vec3d& at, const BuildSettings& settings, bool remapped) {
  Built built;
  for (const TrackForm& own : {TrackForm{0, 1}, TrackForm{4, 1}, TrackForm{1, 3}}) {
    auto object = std::make_shared<Accel>();
    object->add_mesh(turning_sticks(20, own, {}));
    if (remapped) object->set_time_remap(halting());
    object->commit(settings);
    Random random(own.segments + 3);
    std::vector<Affine3f> maps;
    for (std::uint32_t i = 0; i < 4 * form.controls(); ++i) {
      const auto axis = [&](const Vec3f& unit) { return unit * 0.7f + random.direction() * 0.3f; };
      const Vec3f place = Vec3f(at) + random.direction();
      maps.push_back({axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1}), place});
    }
    built.accel.add_instances(object, form, maps, remapped ? halting() : TimeRemap{});
    built.objects.push_back(std::move(object));
  }
  built.accel.commit(settings);
  return built;
}

Built patches(const TrackForm& form, const Vec3d& at, const BuildSettings& settings) {
  Built built;
  for (const auto& cage : {cube_cage(), octahedron_cage()}) {
    DiceSettings dicing{.level = 2};
    if (form.degree == 1) dicing.displacement = bumps(0.08, 0.6, at);  // others are not displaced
    built.accel.add_grids(dice(moved(cage, form, rotation({1, 1, 0}, 0.8), at), dicing));
  }
  BuildSettings cutting = settings;  // as many fragments as may be
  cutting.spatial_split_budget = 8.0f;
  cutting.spatial_split_root_overlap = cutting.spatial_split_node_overlap = 0.0f;
  cutting.sah_time = SahTime::kCentre;
  built.accel.commit(cutting);
  return built;
}

Built round_things(const TrackForm& form, const Vec3d& at, const BuildSettings& settings) {
  Built built;
  Random random(7);
  CurveSet hairs = bench::hairs(12, 3, 0.02f, form, random);
  for (RoundVertex& v : hairs.vertices) v.p = Vec3f(Vec3d(v.p) + at);
  hairs.shape = CurveShape::kTube;
  PointSet balls = bench::balls(40, form, random);
  for (RoundVertex& v : balls.vertices) v.p = Vec3f(Vec3d(v.p) + at);
  built.accel.add_curves(std::move(hairs));
  built.accel.add_points(std::move(balls));
  built.accel.commit(settings);
  return built;
}

const std::vector<Content>& contents() {
  static const std::vector<Content> kContents = {
      {"sticks", [](const TrackForm& f, const Vec3d& at,
                    const BuildSettings& s) { return tree_of({turning_sticks(40, f, at)}, s); }},
      {"triangles without area at the centre", collapsing},
      {"mixed key counts", mixed},
      {"refitted", refitted},
      {"instances", [](const TrackForm& f, const Vec3d& at,
                       const BuildSettings& s) { return instanced(f, at, s, false); }},
      {"instances under time remaps",
       [](const TrackForm& f, const Vec3d& at, const BuildSettings& s) { return instanced(f, at, s, true); }},
      {"patches", patches},
      {"curves and points", round_things},
  };
  return kContents;
}

BoxVerdict judge_content(const Content& content, const TrackForm& form, double offset,
                         const BuildSettings& settings) {
  const Built built = content.make(form, {offset, -offset, 0.3 * offset}, settings);
  const std::vector<float> times = hard_times(std::max(form.segments, 4u), 5);
  BoxVerdict verdict = judge_boxes(built.accel.bvh(), times);
  for (const auto& object : built.objects) verdict += judge_boxes(object->bvh(), times);
  return verdict;
}

// Takes planes as a builder may: between the sides, at a vertex, next to one.
Box3f cut_at_random(const std::array<Vec3d, 3>& centre, Random& random) {
  Box3d whole;
  for (const Vec3d& v : centre) whole.grow(v);
  Box3f box = round_outwards(whole);
  const int cuts = 1 + static_cast<int>(random.next() % 4);
  for (int i = 0; i < cuts; ++i) {
    const int axis = static_cast<int>(random.next() % 3);
    const float at_vertex = static_cast<float>(centre[random.next() % 3][axis]);
    const float planes[] = {random.uniform(box.lo[axis], box.hi[axis]), at_vertex,
                            std::nextafter(at_vertex, 1e30f)};
    const CutBounds cut = cut_bounds(centre, box, axis, planes[random.next() % 3]);
    const Box3f& kept = random.next() % 2 == 0 ? cut.below : cut.above;
    if (!kept.empty()) box = kept;
  }
  return box;
}

// A triangle that may be next to degenerate at the centre, where it is cut, and is large elsewhere.
std::shared_ptr<const TriangleMesh> random_triangle(Random& random) {
  TriangleMesh mesh;
  const TrackForm form = kForms[random.next() % std::size(kForms)];
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  mesh.vertex_count = 3;
  mesh.triangles = {{0, 1, 2}};
  const float size = std::exp2(random.uniform(-20.0f, 20.0f));
  const Vec3f place = random.direction() * (size * std::exp2(random.uniform(-4.0f, 16.0f)));
  const float thin = std::exp2(random.uniform(-24.0f, 0.0f));
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    const bool centre = 2 * c + 1 >= form.controls() && 2 * c <= form.controls();
    for (int v = 0; v < 3; ++v) {
      Vec3f p = random.direction() * size;
      if (centre) p = Vec3f{p.x, p.x * 0.5f, p.x * 0.25f} + p * thin;
      mesh.positions.push_back(place + p);
    }
  }
  return std::make_shared<TriangleMesh>(validated(std::move(mesh)));
}

struct CutVerdict {
  std::uint64_t corners = 0, outside = 0;
};

// The exact polygon that the reference stands for, moved, against the boxes that the builder makes of it.
CutVerdict judge_reference(Random& random) {
  const auto mesh = random_triangle(random);
  const std::shared_ptr<const TriangleMesh> meshes[] = {mesh};
  const Primitives primitives{.meshes = meshes, .instances = {}};
  Reference reference;
  reference.owner = Reference::kClippedFlag;
  reference.box = cut_at_random(centre_triangle<double>(primitives, reference), random);
  TrackForm form = mesh->form();  // or finer, as that of a node with other children
  if (form.moving() && form.segments < 64 && random.next() % 2 == 0) form.segments *= 2;
  std::vector<Box3f> boxes(form.controls());
  grow_by_reference(boxes, form, primitives, reference);

  const auto at_centre = centre_triangle<float>(primitives, reference);
  TrianglePart part = TrianglePart::whole();
  for (const Line& side : sides_of(at_centre, reference.box)) {
    part = part.cut(side);
    if (part.empty()) return {};
  }
  CutVerdict verdict;
  for (const float u : hard_times(form.segments > 8 ? 8 : form.segments, random.next())) {
    for (const Rounding r : kRoundings) {
      Corners corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = track_as(
            r, [&](std::uint32_t c) { return mesh->control_positions(c)[k]; }, mesh->form(),
            locate(u, mesh->segments));
      const Box3f box = track_as(
          r, [&](std::uint32_t c) { return boxes[c]; }, form, locate(u, form.segments));
      for (const Line& side : sides_of(corners, box)) {
        for (std::size_t i = 0; i < part.corners(); ++i) {
          ++verdict.corners;
          verdict.outside += part.side(i, side) < 0;
        }
      }
    }
  }
  return verdict;
}

}  // namespace

TEST_CASE("the judge of boxes knows a triangle that leaves its boxes by the least that there is") {
  const Corners triangle{Vec3f{0, 0, 0}, Vec3f{1, 0, 1}, Vec3f{0, 1, 0x1p-40f}};
  const float above = std::nextafter(0.5f, 1.0f);
  const Box3f left{{0, 0, 0}, {0.5f, 1, 1}}, right{{0.5f, 0, 0}, {1, 1, 1}},
      far_right{{above, 0, 0}, {1, 1, 1}}, low{{0, 0, 0x1p-41f}, {1, 1, 1}};
  CHECK(covers(std::array{left, right}, triangle));
  CHECK(!covers(std::array{left, far_right}, triangle));
  CHECK(!covers(std::array{left}, triangle));
  CHECK(!covers(std::array{low}, triangle));
  CHECK(covers(std::array{low, left, right}, triangle));
  // 1 - 2^-53 + 2^-54 is no double: where the sum is rounded it is 1.
  CHECK(test::sign_of_sum(std::array{1.0, -0x1p-53, 0x1p-54, -1.0, 0x1p-54}) == 0);
  CHECK(test::sign_of_sum(std::array{1.0, -0x1p-53, 0x1p-54, -1.0, 0x1p-54, -0x1p-200}) == -1);
}

TEST_SUITE("slow") {
  TEST_CASE("soak: boxes hold what they bound at hard times, judged exactly") {
    const std::size_t every = test::is_soak() ? 1 : 11;
    std::size_t number = 0;
    BoxVerdict all;
    for (const Content& content : contents()) {
      BoxVerdict of_content;
      for (const TrackForm& form : kForms) {
        for (const double offset : {0.0, 1e4, 1e7}) {
          for (const BuilderName& builder : kBuilders) {
            for (const TreeLayoutName& layout : kTreeLayouts) {
              for (const std::uint32_t slices : {1u, 4u}) {
                if (slices > 1 && (builder.builder != Builder::kMsbvh || form.segments == 0)) continue;
                if (number++ % every != 0) continue;
                BuildSettings settings;
                settings.builder = builder.builder;
                settings.layout = layout.layout;
                settings.time_slices = slices;
                const BoxVerdict verdict = judge_content(content, form, offset, settings);
                CAPTURE(std::string(content.name));
                CAPTURE(form.segments);
                CAPTURE(form.degree);
                CAPTURE(offset);
                CAPTURE(std::string(builder.name));
                CAPTURE(std::string(layout.name));
                CAPTURE(slices);
                CAPTURE(verdict.first);
                CHECK(verdict.outside == 0);
                of_content += verdict;
              }
            }
          }
        }
      }
      CAPTURE(std::string(content.name));
      CHECK(of_content.comparisons > 0);
      all += of_content;
    }
    CHECK(all.cut > 0);
    std::ostringstream figure;
    figure << all.comparisons << " comparisons in " << number / every << " trees, " << all.cut
           << " of them of fragments in several boxes, " << all.outside << " outside";
    test::soak_figure("boxes", figure.str());
    if (std::getenv("MSBVH_TEST_FIGURES")) MESSAGE(figure.str());
  }

  TEST_CASE("soak: fragments, moved, lie in their boxes: exact polygons of random cuts") {
    const std::size_t count = test::soak_count(20'000, 20'000'000);
    constexpr std::size_t kAtOnce = 1000;
    std::vector<CutVerdict> verdicts(count / kAtOnce);
    parallel_for(verdicts.size(), [&](std::size_t i) {
      Random random(i + 1);
      for (std::size_t k = 0; k < kAtOnce; ++k) {
        const CutVerdict verdict = judge_reference(random);
        verdicts[i].corners += verdict.corners;
        verdicts[i].outside += verdict.outside;
      }
    });
    CutVerdict all;
    for (const CutVerdict& verdict : verdicts) {
      all.corners += verdict.corners;
      all.outside += verdict.outside;
    }
    CHECK(all.corners > 0);
    CHECK(all.outside == 0);
    std::ostringstream figure;
    figure << count << " fragments, " << all.corners << " corners against sides, " << all.outside
           << " outside";
    test::soak_figure("fragments", figure.str());
    if (std::getenv("MSBVH_TEST_FIGURES")) MESSAGE(figure.str());
  }
}
