// delegate/translate/frame: values that hold until their next sample, and motions that do.
#include <algorithm>
#include <doctest/doctest.h>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/frame/assemble.h"
#include "delegate/translate/frame/held_parts.h"
#include "delegate/translate/frame/held_values.h"
#include "delegate/translate/sample/even_times.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class NoTextures : public TextureSource {
 public:
};

Matrix4d shifted(double x) { return testing::row_vector_matrix(testing::translation({x, 0, 0})); }

using Times = std::vector<std::pair<double, double>>;

Times times_of(const Visibility& visible) {
  Times result;
  if (!visible) return {{0.0, 2.0}};
  for (const VisibleInterval& part : *visible) result.emplace_back(part.begin01, part.end01);
  return result;
}

// Two triangles, coloured by index.
struct Coloured {
  testing::MeshFixture mesh;
  std::vector<Vec3f> colors{{1, 0, 0}, {0, 1, 0}};
  std::vector<int> first{0, 0}, second{0, 1}, third{1, 1};

  Coloured() {
    mesh.counts = {3, 3};
    mesh.indices = {0, 1, 2, 0, 2, 3};
  }

  FrameShape shape() {
    FrameShape shape;
    shape.mesh = mesh.input();
    shape.mesh.display_color.interpolation = "uniform";
    shape.mesh.display_color.values = colors;
    shape.mesh.display_color.indices = first;
    shape.motion = SampledMotion::still(shifted(0));
    return shape;
  }
};

struct Split {
  std::vector<Diagnostic> said;
  ShapeParts parts;
};

Split split(const FrameShape& shape) {
  Split result;
  PrimLog log(result.said, shape.mesh.path);
  result.parts = parts_of(shape, log);
  return result;
}

AssembledFrame assembled(FrameShape shape) {
  FrameInput frame;
  frame.camera = testing::camera_at({0, 0, 10});
  frame.shutter = {-0.25, 0.25};
  frame.groups.emplace_back().shapes.push_back(std::move(shape));
  return assemble_frame(frame, testing::settings_of(), NoTextures());
}

}  // namespace

TEST_CASE("stretches of equal values are one, in the order of their first appearance") {
  const std::vector<double> begins{0.0, 0.25, 0.5, 0.75};
  const std::vector<HeldStretch> found = held_stretches(begins, std::vector<std::size_t>{0, 1, 0, 2});
  REQUIRE(found.size() == 3);
  CHECK(found[0].first == 0);
  CHECK(times_of(found[0].shown) == Times{{0.0, 0.25}, {0.5, 0.75}});
  CHECK(found[1].first == 1);
  CHECK(times_of(found[1].shown) == Times{{0.25, 0.5}});
  CHECK(found[2].shown->front().end01 > 1.0);  // the closing is a part of it
  const std::vector<HeldStretch> same = held_stretches(begins, std::vector<std::size_t>{3, 3, 3, 3});
  REQUIRE(same.size() == 1);
  CHECK_FALSE(same[0].shown);
}

TEST_CASE("more stretches than there may be are none") {
  std::vector<double> begins;
  std::vector<std::size_t> kinds;
  for (std::size_t i = 0; i < kMostStretches; ++i) {
    begins.push_back(double(i) / 64.0);
    kinds.push_back(i);
  }
  CHECK(held_stretches(begins, kinds).size() == kMostStretches);
  begins.push_back(0.9);
  kinds.push_back(kMostStretches);
  CHECK(held_stretches(begins, kinds).empty());
}

TEST_CASE("knots are the ends of parts and what is authored inside") {
  const std::vector<double> authored{0.1, 0.3, 0.5, 0.9};
  const std::vector<VisibleInterval> shown{{0.0, 0.3}, {0.5, 2.0}};
  CHECK(knots_within(authored, shown) ==
        std::vector{0.0, 0.1, 0.3 - kBeforeJump01, 0.5, 0.9, 1.0 - kBeforeJump01});
}

TEST_CASE("a host's value that stays until its next sample is held") {
  const std::vector<double> times{0.0, 0.25, 0.75};
  CHECK(holds_between(times, [](double time01) { return time01 < 0.75 ? 1 : 2; }));
  CHECK(holds_between(times, [](double time01) { return time01 < 0.4 ? 1 : 2; }));
  CHECK_FALSE(holds_between(times, [](double time01) { return time01; }));
  CHECK_FALSE(holds_between(times, [](double) { return 1; }));
  CHECK_FALSE(holds_between(std::vector{0.5}, [](double time01) { return time01; }));
}

TEST_CASE("jumps are found where they are, and never too early") {
  const std::vector<double> at{0.1234567, 0.5, 0.50001, 0.9};
  const auto value = [&](double time01) {
    return std::ranges::count_if(at, [&](double jump) { return time01 >= jump; });
  };
  const std::vector<double> found = jumps01([&](double a, double b) { return value(a) == value(b); });
  REQUIRE(found.size() == at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    CHECK(found[i] >= at[i]);
    CHECK(found[i] - at[i] < kBeforeJump01);
  }
}

TEST_CASE("a curve has no jumps, and is not looked for them for long") {
  std::size_t asked = 0;
  const auto same = [&](double a, double b) {
    ++asked;
    return a == b;
  };
  CHECK(jumps01(same).empty());
  CHECK(asked < 10000);
}

TEST_CASE("a motion that a host evaluates in steps jumps where the steps are") {
  // A rotate op of a held stage: a host says nothing but the shutter's ends.
  const auto evaluate = [](double time01) { return std::vector{shifted(time01 < 0.3 ? 0.0 : 2.0)}; };
  const auto motion =
      std::make_shared<EvaluatedMotion>(1, false, std::vector{0.0, 1.0}, evaluate, uniform_turns(1.0));
  CHECK(motion->held());
  REQUIRE(motion->breakpoints01().size() == 1);
  CHECK(motion->breakpoints01()[0] == doctest::Approx(0.3).epsilon(1e-6));
  CHECK(motion->turns(0).rate() == 0.0);
  CHECK(NestedMotion(motion, SampledMotion::still(shifted(1))).held());
  testing::MeshFixture mesh;
  FrameShape shape;
  shape.mesh = mesh.input();
  shape.motion = motion;
  const AssembledFrame frame = assembled(shape);
  REQUIRE(frame.tracks.size() == 2);  // the camera's is the first
  CHECK(frame.tracks[1].error_pixels <= 0.1);
  CHECK(frame.tracks[1].segments > 1);
  CHECK_FALSE(frame.scene->instances.empty());
  const EvaluatedMotion line(1, false, {0.0, 1.0}, [](double t) { return std::vector{shifted(t)}; });
  CHECK_FALSE(line.held());
}

TEST_CASE("sampled motions may hold each matrix until the next") {
  const SampledMotion motion({0.0, 0.5}, {shifted(0), shifted(2)}, 1, true);
  CHECK(motion.held());
  CHECK(matrices_at(motion, std::vector{0.49}).front()[12] == 0.0);
  CHECK(matrices_at(motion, std::vector{0.5}).front()[12] == 2.0);
}

TEST_CASE("a shape whose indices change is one for each of their values") {
  Coloured coloured;
  FrameShape shape = coloured.shape();
  CHECK_FALSE(holds_values(shape));
  shape.held.display_color.indices.samples = {
      {-0.5, coloured.first}, {0.25, coloured.second}, {0.5, coloured.first}, {1.5, coloured.third}};
  CHECK(holds_values(shape));
  const Split found = split(shape);
  CHECK(found.said.empty());
  REQUIRE(found.parts.shapes.size() == 2);  // what comes after the closing is not seen
  CHECK(times_of(found.parts.shapes[0].mesh.visible) == Times{{0.0, 0.25}, {0.5, 2.0}});
  CHECK(times_of(found.parts.shapes[1].mesh.visible) == Times{{0.25, 0.5}});
  CHECK(std::ranges::equal(found.parts.shapes[1].mesh.display_color.indices, coloured.second));
  const AssembledFrame frame = assembled(shape);
  REQUIRE(frame.scene->meshes.size() == 2);
  CHECK(frame.diagnostics.empty());
}

TEST_CASE("holes and subsets are those of their part of the shutter") {
  Coloured coloured;
  FrameShape shape = coloured.shape();
  const std::vector<int> none{}, hole{1}, faces{0}, others{1};
  shape.held.holes.samples = {{0.0, none}, {0.5, hole}};
  shape.subsets = {{{"/mesh/part", faces}, "/red", {}}};
  shape.subsets[0].held.samples = {{0.0, faces}, {0.25, others}};
  shape.mesh.visible = std::vector<VisibleInterval>{{0.25, 2.0}};
  const Split found = split(shape);
  REQUIRE(found.parts.shapes.size() == 2);  // the first is hidden throughout
  const FrameShape &middle = found.parts.shapes[0], &last = found.parts.shapes[1];
  CHECK(times_of(middle.mesh.visible) == Times{{0.25, 0.5}});
  CHECK(middle.mesh.hole_indices.empty());
  CHECK(std::ranges::equal(middle.subsets[0].faces.indices, others));
  CHECK(times_of(last.mesh.visible) == Times{{0.5, 2.0}});
  CHECK(std::ranges::equal(last.mesh.hole_indices, hole));
}

TEST_CASE("values whose number changes with their indices follow their own samples") {
  Coloured coloured;
  FrameShape shape = coloured.shape();
  const std::vector<Vec3f> begin{{0, 0, 0}, {0, 0, 0}}, middle{{1, 1, 1}, {1, 1, 1}}, one{{0, 0, 1}};
  shape.mesh.display_color.samples = {{0.0, begin}, {0.5, middle}, {0.75, one}};
  shape.held.display_color.indices.samples = {{0.0, coloured.second}, {0.75, coloured.first}};
  const Split found = split(shape);
  CHECK(found.said.empty());
  // Until 0.5 it goes from black to white; there the number of values is another than that of the next.
  REQUIRE(found.parts.shapes.size() == 3);
  const PrimvarInput<Vec3f>& rising = found.parts.shapes[0].mesh.display_color;
  REQUIRE(rising.samples.size() == 2);
  CHECK(rising.samples[0].values[0] == Vec3f{0, 0, 0});
  CHECK(rising.samples[1].values[0].x == doctest::Approx(1.0));
  const PrimvarInput<Vec3f>& blue = found.parts.shapes[2].mesh.display_color;
  CHECK(blue.values.size() == 1);
  CHECK(std::ranges::equal(blue.indices, coloured.first));
  CHECK(assembled(shape).diagnostics.empty());
}

TEST_CASE("values that a stage holds are still in each part") {
  Coloured coloured;
  FrameShape shape = coloured.shape();
  const std::vector<Vec3f> red(2, {1, 0, 0}), blue(2, {0, 0, 1});
  shape.mesh.display_color.indices = {};
  shape.mesh.display_color.samples = {{0.0, red}, {0.5, blue}};
  shape.held.display_color.values = true;
  const Split found = split(shape);
  REQUIRE(found.parts.shapes.size() == 2);
  CHECK(found.parts.shapes[0].mesh.display_color.values[0] == Vec3f{1, 0, 0});
  CHECK(found.parts.shapes[1].mesh.display_color.values[0] == Vec3f{0, 0, 1});
  for (const FrameShape& part : found.parts.shapes) CHECK(part.mesh.display_color.samples.empty());
}

TEST_CASE("what changes with the topology, or too often, stays as at the frame, with a word") {
  Coloured coloured;
  FrameShape shape = coloured.shape();
  shape.held.display_color.indices.samples = {{0.0, coloured.second}, {0.5, coloured.third}};
  shape.mesh.topology_varies = true;
  const Split varying = split(shape);
  REQUIRE(varying.parts.shapes.size() == 1);
  CHECK(std::ranges::equal(varying.parts.shapes[0].mesh.display_color.indices, coloured.first));
  REQUIRE(varying.said.size() == 1);
  CHECK(varying.said[0].attribute == "primvars:displayColor:indices");
  CHECK(varying.said[0].message == "changes within the shutter; held the frame's value, as its topology");

  shape.mesh.topology_varies = false;
  std::vector<std::vector<int>> many;
  for (int i = 0; i <= int(kMostStretches); ++i) many.push_back({i, 0});
  shape.held.display_color.indices.samples.clear();
  for (std::size_t i = 0; i < many.size(); ++i)
    shape.held.display_color.indices.samples.emplace_back(double(i) / 64.0, many[i]);
  const Split often = split(shape);
  REQUIRE(often.parts.shapes.size() == 1);
  REQUIRE(often.said.size() == 1);
  CHECK(often.said[0].message ==
        "found more values within the shutter, expected at most 32; held the frame's");
}
