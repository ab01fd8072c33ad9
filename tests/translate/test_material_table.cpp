// A scene's materials as they are handed down, and the primvars that prims bring along for them.
#include <array>
#include <doctest/doctest.h>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/material_table.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

TEST_CASE("materials share textures and names of primvars in the scene") {
  Scene scene;
  MaterialTable table;
  std::vector<Diagnostic> said;
  PrimLog log(said, "/Look");
  const auto look = [](std::string name, std::string path, std::string primvar) {
    SurfaceLook result;
    result.material.name = std::move(name);
    result.textures = {{.name = path, .tiles = {{0, 0, {std::move(path)}}}}};
    result.primvars = {{"unused", 1}, {std::move(primvar), 2}};
    result.material.texture_reads = {{.coordinates = 1}};
    result.material.driven = {{SurfaceInput::kDiffuseColor, DrivenInput::Source::kTexture, 0}};
    return result;
  };
  CHECK(table.add(look("/A", "/wood.png", "st"), scene, log) == 0);
  CHECK(table.add(look("/B", "/wood.png", "uv"), scene, log) == 1);
  SurfaceLook third = look("/C", "/wood.png", "st");
  third.textures.front().name = "../wood.png";  // the same file by another name
  CHECK(table.add(third, scene, log) == 2);
  third.textures.front().wrap_s = TextureWrap::kRepeat;
  table.add(third, scene, log);
  CHECK(scene.textures.size() == 2);
  CHECK(scene.primvar_names == std::vector<std::string>{"st", "uv"});
  CHECK(scene.materials[1].texture_reads.front().coordinates == 1);
  CHECK(scene.materials[2].texture_reads.front().texture == 0);
  CHECK(scene.materials[3].texture_reads.front().texture == 1);
  CHECK(table.reads(1).size() == 1);
  CHECK(table.reads(7).empty());
  CHECK(table.find("uv") == 1);
  CHECK(table.find("unused") == kNoPrimvar);
  CHECK(said.empty());
  SurfaceLook broken = look("/D", "/wood.png", "st");
  broken.material.texture_reads.front().texture = 3;
  CHECK_THROWS_AS(table.add(broken, scene, log), Error);
  broken = look("/E", "/wood.png", "st");
  broken.material.roughness = std::numeric_limits<float>::quiet_NaN();
  CHECK(scene.materials[table.add(broken, scene, log)].driven.empty());
  CHECK(said.size() == 1);
}

using namespace msbvh::translate::testing;

namespace {

// A material that reads st, and another primvar for its roughness.
SurfaceLook reading(const std::string& primvar = "wet") {
  SurfaceLook look;
  look.textures = {{.name = "wood.png", .tiles = {{0, 0, {"/wood.png"}}}}};
  look.primvars = {{"st", 2}, {primvar, 1}};
  look.material.name = "/Look";
  look.material.texture_reads = {{.coordinates = 0}};
  look.material.driven = {{SurfaceInput::kDiffuseColor, DrivenInput::Source::kTexture, 0},
                          {SurfaceInput::kRoughness, DrivenInput::Source::kPrimvar, 1}};
  return look;
}

const std::vector<Vec3f> kCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<Vec3f> kOne{{0.5f, 0, 0}};

NamedPrimvar named(std::string name, std::string interpolation, std::span<const Vec3f> values) {
  return {std::move(name), {std::move(interpolation), values}};
}

struct Translated {
  std::shared_ptr<const Scene> scene;
  std::vector<Diagnostic> said;
};

// With materials 0, which reads, and 1, which does not.
Translated translated(const MeshInput& input, TranslatorSettings settings = settings_of()) {
  Translator translator(camera_at({0, 0, 10}), settings);
  translator.add_material(reading());
  translator.add_material(Material{});
  translator.add_mesh(input);
  Translated result{nullptr, translator.diagnostics()};
  result.scene = translator.finish();
  validate(*result.scene);
  return result;
}

}  // namespace

TEST_CASE("a mesh keeps the primvars that its materials read, of any interpolation, and no others") {
  MeshFixture fixture;
  MeshInput input = fixture.input();
  input.material = 0;
  for (const auto& [interpolation, kept, count] : {std::tuple{"constant", Interpolation::kConstant, 1u},
                                                   {"uniform", Interpolation::kTriangle, 2u},
                                                   {"varying", Interpolation::kVertex, 4u},
                                                   {"vertex", Interpolation::kVertex, 4u},
                                                   {"faceVarying", Interpolation::kFaceVarying, 6u}}) {
    CAPTURE(interpolation);
    const bool one = std::string(interpolation) == "constant" || std::string(interpolation) == "uniform";
    input.named_primvars = {named("unread", "constant", kOne),
                            named("st", interpolation, one ? std::span<const Vec3f>(kOne) : kCorners)};
    const Translated found = translated(input);
    CHECK(found.said.empty());
    const Mesh& mesh = found.scene->meshes.at(0);
    REQUIRE(mesh.primvars.size() == 1);
    CHECK(found.scene->primvar_names[mesh.primvars[0].name] == "st");
    CHECK(mesh.primvars[0].primvar.interpolation == kept);
    CHECK(mesh.primvars[0].primvar.values.size() == count);
  }
  input.material = 1;
  CHECK(translated(input).scene->meshes.at(0).primvars.empty());
  const std::vector<int> faces{0};
  input.face_materials = faces;
  CHECK(translated(input).scene->meshes.at(0).primvars.size() == 1);
}

TEST_CASE("a primvar that does not fit, or is not finite, is left out with a warning") {
  MeshFixture fixture;
  MeshInput input = fixture.input();
  input.material = 0;
  const std::vector<Vec3f> broken{{std::numeric_limits<float>::quiet_NaN(), 0, 0}};
  input.named_primvars = {named("st", "faceVarying", kOne), named("wet", "constant", broken)};
  const Translated found = translated(input);
  CHECK(found.scene->meshes.at(0).primvars.empty());
  REQUIRE(found.said.size() == 2);
  CHECK(found.said[0].attribute == "primvars:st");
  CHECK(found.said[1].attribute == "primvars:wet");
}

TEST_CASE("coordinates that move keep the keys that they need, closer than colours") {
  MeshFixture fixture;
  MeshInput input = fixture.input();
  input.material = 0;
  std::vector<Vec3f> middle = kCorners;
  for (Vec3f& st : middle) st.x += 0.001f;  // off the line between the ends by less than a step of 8 bits
  input.named_primvars = {named("st", "vertex", kCorners)};
  input.named_primvars[0].primvar.samples = {{0.0, kCorners}, {0.5, middle}, {1.0, kCorners}};
  const Primvar<Vec3f> st = translated(input).scene->meshes.at(0).primvars.at(0).primvar;
  CHECK(st.segments == 2);
  CHECK(st.values.size() == 12);
}

TEST_CASE("a subdivided mesh's primvars are refined with it, face-varying ones by their own topology") {
  MeshFixture fixture;
  MeshInput input = fixture.input();
  input.material = 0;
  input.subdivision.scheme = "catmullClark";
  TranslatorSettings settings = settings_of(100);
  for (const char* interpolation : {"vertex", "varying", "faceVarying"}) {
    CAPTURE(interpolation);
    input.named_primvars = {named("st", interpolation, kCorners), named("wet", "uniform", kOne)};
    const Translated found = translated(input, settings);
    const Mesh& mesh = found.scene->meshes.at(0);
    CHECK(mesh.shape.triangles.size() > 2);
    REQUIRE(mesh.primvars.size() == 2);
    for (const Vec3f& st : mesh.primvars[0].primvar.values) {
      CHECK(st.x >= 0.0f);
      CHECK(st.x <= 1.0f);
    }
    CHECK(mesh.primvars[1].primvar.values.size() == mesh.shape.triangles.size());
  }
}

TEST_CASE("curves and points keep primvars in their own ways") {
  MeshFixture fixture;
  MeshInput input = fixture.input();
  input.face_vertex_counts = {};
  input.face_vertex_indices = {};
  input.material = 0;
  input.round.kind = RoundInput::Kind::kPoints;
  const std::vector<float> widths{0.1f};
  input.round.widths = {"constant", widths};
  input.named_primvars = {named("st", "vertex", kCorners), named("wet", "constant", kOne)};
  const Translated points = translated(input);
  REQUIRE(points.scene->points.at(0).primvars.size() == 2);
  CHECK(points.scene->points[0].primvars[0].primvar.interpolation == Interpolation::kTriangle);
  CHECK(points.scene->points[0].primvars[1].primvar.interpolation == Interpolation::kConstant);

  input.round.kind = RoundInput::Kind::kCurves;
  input.round.topology.type = "linear";
  const std::vector<int> counts{4};
  input.round.topology.vertex_counts = counts;
  input.named_primvars[1] = named("wet", "uniform", kOne);
  const Translated curves = translated(input);
  REQUIRE(curves.scene->curves.at(0).primvars.size() == 2);
  CHECK(curves.scene->curves[0].primvars[0].primvar.interpolation == Interpolation::kVertex);
  CHECK(curves.scene->curves[0].primvars[1].primvar.interpolation == Interpolation::kTriangle);
}

TEST_CASE("instances keep values of their own for what is read, and opacities") {
  MeshFixture fixture;
  Translator translator(camera_at({0, 0, 10}), settings_of());
  translator.add_material(reading());
  const std::uint32_t prototype = translator.begin_prototype("/prototype");
  MeshInput mesh = fixture.input();
  mesh.material = 0;
  translator.add_prototype_mesh(prototype, mesh);
  const std::vector<Matrix4d> matrices(3, row_vector_matrix(translation({0, 0, 1})));
  InstancesInput input = instances_of("/instances", prototype, {0.0}, matrices);
  const std::vector<Vec3f> wet{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const std::vector<float> opacities{0.25f, 0.5f, 1.0f};
  input.primvars = {named("wet", "vertex", wet), named("unread", "vertex", wet), named("st", "vertex", kOne)};
  input.display_opacity = opacities;
  translator.add_instances(input);
  const std::vector<Diagnostic> said = translator.diagnostics();
  REQUIRE(said.size() == 1);
  CHECK(said[0].attribute == "primvars:st");
  const auto scene = translator.finish();
  validate(*scene);
  const InstanceSet& set = scene->instances.at(0);
  REQUIRE(set.primvars.size() == 1);
  CHECK(scene->primvar_names[set.primvars[0].name] == "wet");
  CHECK(set.primvars[0].values == wet);
  CHECK(set.display_opacity == opacities);
}
