// Prims that no ray can reach are left out: counted, with the reason, and with the numbers of the others as
// they were.
#include <doctest/doctest.h>

#include "core/scene/scene.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

TranslatorSettings with_bounces(std::optional<std::uint32_t> max_bounces) {
  TranslatorSettings settings = settings_of(100);
  settings.max_bounces = max_bounces;
  return settings;
}

MeshFixture quad_at(std::string path, const Vec3d& place) {
  MeshFixture quad;
  quad.path = std::move(path);
  quad.transform = still(translation(place));
  return quad;
}

LightInput light_of(LightKind kind, const Vec3f& radiance) {
  LightInput input;
  input.light.name = "/light";
  input.light.kind = kind;
  input.light.radiance = radiance;
  input.world_from_light = still();
  return input;
}

struct Found {
  std::shared_ptr<const Scene> scene;
  std::vector<LeftOut> left_out;
};

Found finished(Translator& translator) {
  CHECK(translator.diagnostics().empty());
  auto scene = translator.finish();
  validate(*scene);
  return {std::move(scene), translator.left_out()};
}

// Quads outside of the picture and in it, in this order.
Found two_quads(std::optional<std::uint32_t> max_bounces, const LightInput& light) {
  Translator translator(camera_at({0, 0, 10}), with_bounces(max_bounces));
  translator.add_mesh(quad_at("/outside", {40, 0, 0}).input());
  translator.add_mesh(quad_at("/inside", {0, 0, 0}).input());
  translator.add_light(light);
  return finished(translator);
}

// Two instances of a quad for each place, still.
void add_instances(Translator& translator, const char* path, const std::vector<Vec3d>& places,
                   bool hidden = false) {
  const std::uint32_t prototype = translator.begin_prototype("/prototype");
  translator.add_prototype_mesh(prototype, MeshFixture().input());
  std::vector<Matrix4d> matrices;
  for (const Vec3d& place : places) matrices.push_back(row_vector_matrix(translation(place)));
  InstancesInput input = instances_of(path, prototype, {0.0}, matrices);
  if (hidden) input.visible.emplace();
  translator.add_instances(input);
}

std::size_t triangles(const Scene& scene) {
  std::size_t result = 0;
  for (const Mesh& mesh : scene.meshes) result += mesh.shape.triangles.size();
  return result;
}

}  // namespace

TEST_SUITE("translate: unreached") {
  TEST_CASE("what is outside of the picture is left out where rays go nowhere but from the camera") {
    for (const LightInput& light :
         {light_of(LightKind::kCamera, {1, 1, 1}), light_of(LightKind::kRect, {})}) {
      const Found found = two_quads(0, light);
      REQUIRE(found.left_out.size() == 1);
      CHECK(found.left_out[0].path == "/outside");
      CHECK(found.left_out[0].why == Unreached::kOutsidePicture);
      CHECK(found.scene->world.size() == 1);
      CHECK(triangles(*found.scene) == 2);
      // AOVs number prims by their places.
      REQUIRE(found.scene->meshes.size() == 2);
      CHECK(found.scene->meshes[0].shape.name == "/outside");
      CHECK(found.scene->world[0].index() == 1);
    }
  }

  TEST_CASE("black lights send nothing on, whatever the bounces") {
    CHECK(two_quads(2, light_of(LightKind::kDistant, {})).left_out.size() == 1);
  }

  TEST_CASE("shadows and bounces reach what is outside of the picture") {
    const auto kept = [](const Found& found) {
      return found.left_out.empty() && found.scene->world.size() == 2;
    };
    CHECK(kept(two_quads(0, light_of(LightKind::kDistant, {1, 1, 1}))));
    CHECK(kept(two_quads(0, light_of(LightKind::kDome, {1, 1, 1}))));
    CHECK(kept(two_quads(1, light_of(LightKind::kCamera, {1, 1, 1}))));
    CHECK(kept(two_quads({}, light_of(LightKind::kCamera, {1, 1, 1}))));  // bounces not known
  }

  TEST_CASE("a surface that glows sends light on") {
    for (const std::uint32_t bounces : {0u, 1u}) {
      Translator translator(camera_at({0, 0, 10}), with_bounces(bounces));
      Material material;
      material.name = "/glows";
      material.emissive_color = {1, 1, 1};
      translator.add_material(material);
      translator.add_mesh(quad_at("/outside", {40, 0, 0}).input());
      CHECK(finished(translator).left_out.size() == (bounces == 0 ? 1 : 0));
    }
  }

  TEST_CASE("what passes through the picture within the shutter stays") {
    Translator translator(camera_at({0, 0, 10}), with_bounces(0));
    MeshFixture passes = quad_at("/passes", {});
    passes.transform = sampled([](double u) { return translation({-40 + 80 * u, 0, 0}); }, uniform_times(8));
    translator.add_mesh(passes.input());
    MeshFixture stays_away = quad_at("/staysAway", {});
    stays_away.transform = sampled(
        [](double u) {
          return translation({-40 + 10 * u, 0, 0});
        },
        uniform_times(8));
    translator.add_mesh(stays_away.input());
    const Found found = finished(translator);
    REQUIRE(found.left_out.size() == 1);
    CHECK(found.left_out[0].path == "/staysAway");
    CHECK(found.scene->instances.size() == 1);
  }

  TEST_CASE("instances are left out together: one that may be seen keeps the others and their numbers") {
    Translator translator(camera_at({0, 0, 10}), with_bounces(0));
    add_instances(translator, "/away", {{40, 0, 0}, {-40, 0, 0}, {0, 0, 20}});
    add_instances(translator, "/partly", {{40, 0, 0}, {0, 0, 0}});
    const Found found = finished(translator);
    REQUIRE(found.left_out.size() == 1);
    CHECK(found.left_out[0].path == "/away");
    CHECK(found.left_out[0].count == 3);
    REQUIRE(found.scene->instances.size() == 1);
    CHECK(instance_count(found.scene->instances[0]) == 2);
    CHECK(triangles(*found.scene) == 2);  // the other prototype is empty
    CHECK(found.scene->meshes.size() == 2);
  }

  TEST_CASE("what is hidden throughout the shutter is left out of any render") {
    Translator translator(camera_at({0, 0, 10}), with_bounces({}));
    translator.add_light(light_of(LightKind::kDome, {1, 1, 1}));
    MeshFixture hidden = quad_at("/hidden", {});
    MeshInput input = hidden.input();
    input.visible.emplace();
    translator.add_mesh(input);
    add_instances(translator, "/hiddenInstances", {{0, 0, 0}, {1, 0, 0}}, true);
    translator.add_mesh(quad_at("/inside", {0, 0, 0}).input());
    const Found found = finished(translator);
    REQUIRE(found.left_out.size() == 2);
    for (const LeftOut& prim : found.left_out) CHECK(prim.why == Unreached::kHidden);
    CHECK(found.left_out[1].count == 2);
    CHECK(found.scene->instances.empty());
    CHECK(triangles(*found.scene) == 2);
  }
}
