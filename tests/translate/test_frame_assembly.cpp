// delegate/translate/frame: motions, levels and whole frames, with motions of its own in place of a host's.
#include <cmath>
#include <doctest/doctest.h>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/frame/array_motion.h"
#include "delegate/translate/frame/assemble.h"
#include "delegate/translate/frame/motions.h"
#include "delegate/translate/frame/placed_levels.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class NoTextures : public TextureSource {
 public:
};

Matrix4d shifted(double x, double y = 0.0, double z = 0.0) {
  return testing::row_vector_matrix(testing::translation({x, y, z}));
}

MotionPointer at(double x, double y = 0.0, double z = 0.0) { return SampledMotion::still(shifted(x, y, z)); }

// Turns about z at `radius`, asked for at any time.
MotionPointer rotor(double turns) {
  const auto evaluate = [turns](double time01) {
    return std::vector{testing::row_vector_matrix(testing::rotation(360.0 * turns * time01))};
  };
  return std::make_shared<EvaluatedMotion>(1, false, std::vector<double>{}, evaluate, uniform_turns(turns));
}

Matrix4d matrix_at(const MotionSource& motion, double time01, std::uint32_t which = 0) {
  Matrix4d matrix;
  motion.evaluate(std::span(&time01, 1), std::span(&which, 1), std::span(&matrix, 1));
  return matrix;
}

FrameInput frame_of(FrameGroup group) {
  FrameInput frame;
  frame.camera = testing::camera_at({0, 0, 10});
  frame.shutter = {-0.25, 0.25};
  frame.groups.push_back(std::move(group));
  return frame;
}

FrameShape shape_of(const testing::MeshFixture& mesh, MotionPointer motion) {
  FrameShape shape;
  shape.mesh = mesh.input();
  shape.motion = std::move(motion);
  return shape;
}

AssembledFrame assembled(const FrameInput& frame) {
  return assemble_frame(frame, testing::settings_of(), NoTextures());
}

}  // namespace

TEST_CASE("sampled motions are lines between their times and held outside") {
  const SampledMotion motion({-0.5, 0.5, 1.5}, {shifted(0), shifted(2), shifted(8)});
  CHECK(matrix_at(motion, 0.0)[12] == 1.0);
  CHECK(matrix_at(motion, 0.5)[12] == 2.0);
  CHECK(matrix_at(motion, 1.0)[12] == 5.0);
  CHECK(matrix_at(motion, 9.0)[12] == 8.0);
  CHECK(matrix_at(motion, -9.0)[12] == 0.0);
  CHECK(motion.breakpoints01() == std::vector{0.5});
  CHECK_FALSE(motion.still());
  CHECK(SampledMotion({0.0, 1.0}, {shifted(1), shifted(1)}).still());
  CHECK_THROWS_AS(SampledMotion({0.0, 1.0}, {shifted(1)}), Error);
}

TEST_CASE("nested motions multiply, the outer index first") {
  const auto inner =
      std::make_shared<SampledMotion>(std::vector{0.0}, std::vector{shifted(1), shifted(2)}, 2);
  const auto outer = std::make_shared<SampledMotion>(
      std::vector{0.0, 1.0}, std::vector{shifted(10), shifted(20), shifted(30), shifted(40)}, 2);
  const NestedMotion nested(inner, outer);
  CHECK(nested.count() == 4);
  CHECK(matrix_at(nested, 0.0, 1)[12] == 12.0);
  CHECK(matrix_at(nested, 0.0, 2)[12] == 21.0);
  CHECK(matrix_at(nested, 1.0, 3)[12] == 42.0);
  const SelectedMotion some(std::make_shared<NestedMotion>(inner, outer), {3, 0});
  CHECK(matrix_at(some, 0.0, 0)[12] == 22.0);
  CHECK_THROWS_AS(SelectedMotion(inner, {2}), Error);
  CHECK((NestedMotion(rotor(1.0), rotor(2.0)).turns(0).rate() == doctest::Approx(3.0)));
}

TEST_CASE("an evaluated motion that has too few matrices has unknown ones") {
  const EvaluatedMotion motion(2, false, {}, [](double) { return std::vector{shifted(1)}; });
  CHECK(matrix_at(motion, 0.0, 0)[12] == 1.0);
  CHECK(std::isnan(matrix_at(motion, 0.0, 1)[12]));
}

TEST_CASE("levels are sampled as densely as each needs, and keep the instances' numbers") {
  // Two instances, of which one turns whole turns, under two places that stand.
  const auto pair = std::make_shared<EvaluatedMotion>(
      2, false, std::vector<double>{},
      [](double time01) {
        return std::vector{shifted(3.0 * time01),
                           testing::row_vector_matrix(testing::rotation(720.0 * time01))};
      },
      uniform_turns(2.0));
  const auto places =
      std::make_shared<SampledMotion>(std::vector{0.0}, std::vector{shifted(0, 5), shifted(0, 9)}, 2);
  const std::vector<PlacedLevel> levels{{pair, nullptr, {}}, {places, nullptr, {}}};
  const Box3d box{{-1, -1, -1}, {1, 1, 1}};
  const LevelParts found = sample_levels(
      levels, box, {[](const std::vector<InstanceLevel>&, const Box3d&) { return 100.0; }, 0.1});
  CHECK(found.unusable == 0);
  std::vector<bool> seen(4, false);
  for (const SampledLevels& part : found.parts) {
    REQUIRE(part.levels.size() == 2);
    const std::size_t inner = part.levels[0].matrices.size() / part.levels[0].times01.size();
    CHECK(part.instances.size() == inner * 2);
    for (const std::int32_t instance : part.instances) {
      CHECK_FALSE(seen[std::size_t(instance)]);
      seen[std::size_t(instance)] = true;
    }
  }
  CHECK(seen == std::vector<bool>(4, true));
}

TEST_CASE("a matrix that is no number leaves its instance out, and the others in") {
  const auto half = std::make_shared<EvaluatedMotion>(2, false, std::vector<double>{},
                                                      [](double) { return std::vector{shifted(1)}; });
  const std::vector<PlacedLevel> levels{{half, nullptr, {}}};
  const LevelParts found =
      sample_levels(levels, {{0, 0, 0}, {1, 1, 1}},
                    {[](const std::vector<InstanceLevel>&, const Box3d&) { return 1.0; }, 0.1});
  CHECK(found.unusable == 1);
  std::size_t left = 0;
  for (const SampledLevels& part : found.parts) left += part.instances.size();
  CHECK(left == 1);
}

TEST_CASE("a frame has its meshes, the moving ones as moving transforms") {
  testing::MeshFixture still, turning;
  still.path = "/still";
  turning.path = "/turning";
  FrameGroup world;
  world.shapes = {shape_of(still, at(0)), shape_of(turning, rotor(1.0))};
  const AssembledFrame frame = assembled(frame_of(world));
  CHECK_FALSE(frame.empty);
  REQUIRE(frame.scene->meshes.size() == 2);
  CHECK(frame.scene->world.size() == 1);
  REQUIRE(frame.scene->instances.size() == 1);
  CHECK(frame.scene->instances[0].segments >= 8);
  CHECK(frame.scene->instances[0].ids == std::vector<std::int32_t>{-1});
  CHECK(frame.scene->lights.size() == 1);  // the camera's, where there is no other
  CHECK(frame.scene->lights[0].kind == LightKind::kCamera);
  for (const TrackReport& track : frame.tracks) CHECK(track.error_pixels <= 0.1);
}

TEST_CASE("prim ids and instance ids are those of the front-end") {
  testing::MeshFixture mesh;
  const auto places = std::make_shared<EvaluatedMotion>(3, false, std::vector<double>{}, [](double time01) {
    return std::vector{shifted(0), shifted(1 + time01), shifted(4)};
  });
  FrameGroup group;
  group.path = "/instancer";
  group.shapes = {shape_of(mesh, at(0))};
  group.shapes[0].mesh.prim_id = 17;
  group.levels = {{places, nullptr, {}}};
  const AssembledFrame frame = assembled(frame_of(group));
  REQUIRE(frame.scene->meshes.size() == 1);
  CHECK(frame.scene->meshes[0].prim_id == 17);
  std::vector<std::int32_t> ids;
  for (const InstanceSet& set : frame.scene->instances) {
    if (set.segments > 0) CHECK(set.ids == std::vector<std::int32_t>{1});
    for (std::size_t i = 0; i < instance_count(set); ++i)
      ids.push_back(set.ids.empty() ? std::int32_t(i) : set.ids[i]);
  }
  std::ranges::sort(ids);
  CHECK(ids == std::vector<std::int32_t>{0, 1, 2});
}

TEST_CASE("a point instancer's arrays are a level, its selected instances count") {
  testing::MeshFixture mesh;
  const std::vector<Vec3f> positions{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}};
  auto arrays = std::make_shared<PointInstancerInput>();
  arrays->path = "/instancer";
  arrays->count = 3;
  arrays->positions.samples = {{0.0, positions}};
  FrameGroup group;
  group.path = "/instancer";
  group.shapes = {shape_of(mesh, at(0))};
  group.levels = {{nullptr, arrays, {2, 0}}, {at(0, 1), nullptr, {}}};
  const std::vector<Vec3f> colors{{1, 0, 0}, {0, 1, 0}};
  group.display_color.values = colors;
  const AssembledFrame frame = assembled(frame_of(group));
  REQUIRE(frame.scene->instances.size() == 1);
  const InstanceSet& set = frame.scene->instances[0];
  REQUIRE(instance_count(set) == 2);
  CHECK(double(set.world_from_prototype[0].t.x) - double(set.world_from_prototype[1].t.x) ==
        doctest::Approx(4.0));
  CHECK(set.display_color.size() == 2);
}

TEST_CASE("a point instancer's arrays are a motion, for what is placed one by one") {
  const std::vector<Vec3f> positions{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}},
      velocities{{0, 0, 0}, {0, 0, 0}, {0, 48, 0}}, spins{{0, 0, 0}, {0, 0, 0}, {0, 0, 24.0f * 720.0f}};
  const std::vector<Quatf> upright(3, {0, 0, 0, 1});
  auto arrays = std::make_shared<PointInstancerInput>();
  arrays->path = "/instancer";
  arrays->count = 3;
  arrays->positions.samples = {{0.0, positions}};
  arrays->orientations.samples = {{0.0, upright}};
  arrays->rates.velocities.samples = {{0.0, velocities}};
  arrays->angular_velocities.samples = {{0.0, spins}};
  arrays->time_remap = rate_times({0.0, 1.0}, 24.0);
  std::vector<Diagnostic> said;
  PrimLog log(said, "/instancer");
  const MotionPointer motion = motion_of({nullptr, arrays, {2, 1}}, log);
  REQUIRE(motion);
  CHECK(said.empty());
  CHECK(motion->count() == 2);
  CHECK_FALSE(motion->still());
  CHECK(motion->turns(0).rate() >= 2.0);
  const Matrix4d moved = matrix_at(*motion, 0.5, 0), other = matrix_at(*motion, 0.5, 1);
  CHECK(moved[12] == doctest::Approx(4.0));
  CHECK(moved[13] == doctest::Approx(1.0));  // 48 units a second, half a frame of 24
  CHECK(moved[0] == doctest::Approx(1.0));   // after one whole turn
  CHECK(other[12] == doctest::Approx(2.0));
  CHECK(matrix_at(*motion, 0.125, 0)[1] == doctest::Approx(1.0));  // a quarter turn
  CHECK_FALSE(motion_of({nullptr, arrays, {7}}, log));
  CHECK(said.size() == 1);
  CHECK(motion_of({at(1), nullptr, {}}, log)->count() == 1);
}

TEST_CASE("colours that do not fit the instances are left out, with a word") {
  testing::MeshFixture mesh;
  FrameGroup group;
  group.path = "/instancer";
  group.shapes = {shape_of(mesh, at(0))};
  group.levels = {{at(1), nullptr, {}}};
  const std::vector<Vec3f> colors{{1, 0, 0}, {0, 1, 0}};
  group.display_color.values = colors;
  const AssembledFrame frame = assembled(frame_of(group));
  REQUIRE(frame.diagnostics.size() == 1);
  CHECK(frame.diagnostics[0].message == "found 2 values, expected 1, one an instance; ignored");
  REQUIRE(frame.scene->instances.size() == 1);
  CHECK(frame.scene->instances[0].display_color.empty());
}

TEST_CASE("materials are handed down once, faces by their subsets") {
  testing::MeshFixture mesh;
  mesh.counts = {3, 3};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  FrameGroup world;
  world.shapes = {shape_of(mesh, at(0)), shape_of(mesh, at(3))};
  const std::vector<int> second{1};
  for (FrameShape& shape : world.shapes) shape.material = "/red";
  world.shapes[0].subsets = {{{"/mesh/part", second}, "/green"}};
  FrameInput frame = frame_of(world);
  for (const auto& [path, color] : {std::pair<std::string, std::vector<double>>{"/red", {1, 0, 0}},
                                    std::pair<std::string, std::vector<double>>{"/green", {0, 1, 0}}}) {
    FrameMaterial material{path, {path}};
    ShaderInput diffuse{"diffuseColor"};
    diffuse.value = {color, "a colour", "color3f"};
    material.network.nodes = {{path + "/surface", "UsdPreviewSurface", {diffuse}}};
    material.network.terminals = {{"surface", {path + "/surface", "surface"}}};
    frame.materials.push_back(material);
  }
  const AssembledFrame found = assembled(frame);
  REQUIRE(found.scene->materials.size() == 2);
  REQUIRE(found.scene->meshes.size() == 2);
  CHECK(found.scene->meshes[0].triangle_materials == std::vector<std::uint32_t>{0, 1});
  CHECK(found.scene->meshes[1].material == 0);
  CHECK(found.scene->materials[1].diffuse_color == Vec3f{0, 1, 0});
}

TEST_CASE("a shape whose transform is no number is named, the rest is there") {
  testing::MeshFixture good, bad;
  bad.path = "/bad";
  FrameGroup world;
  world.shapes = {shape_of(good, at(0)), shape_of(bad, at(std::nan("")))};
  const AssembledFrame frame = assembled(frame_of(world));
  CHECK(frame.scene->meshes.size() == 1);
  REQUIRE(frame.diagnostics.size() == 1);
  CHECK(frame.diagnostics[0].path == "/bad");
  CHECK(frame.diagnostics[0].severity == Severity::kError);
}
