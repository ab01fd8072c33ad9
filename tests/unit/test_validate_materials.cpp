// The gate of materials and what they read.
#include <cmath>
#include <doctest/doctest.h>

#include "tests/unit/valid_scene.h"

namespace msbvh {
namespace {

// A material whose roughness an image drives, and whose metallic a primvar that the mesh has.
Scene textured_scene() {
  Scene scene = valid_scene();
  scene.primvar_names = {"st", "wet"};
  scene.textures = {{.name = "wood.png", .tiles = {{0, 0, {"/wood.png"}}}}};
  Material& material = scene.materials[0];
  material.texture_reads = {{.texture = 0, .coordinates = 0}};
  material.driven = {{SurfaceInput::kRoughness, DrivenInput::Source::kTexture, 0, 3},
                     {SurfaceInput::kMetallic, DrivenInput::Source::kPrimvar, 1}};
  scene.meshes[0].primvars = {{0, {Interpolation::kVertex, 0, std::vector<Vec3f>(4)}},
                              {1, {Interpolation::kConstant, 0, {{}}}}};
  scene.instances[0].primvars = {{1, std::vector<Vec3f>(3)}};
  return scene;
}

TEST_CASE("what materials read must be there, each name and input once, and fit") {
  Scene scene = textured_scene();
  Material& material = scene.materials[0];
  std::string expected;
  SUBCASE("as it is") {}
  SUBCASE("texture") {
    material.texture_reads[0].texture = 1;
    expected = "/material: texture: found index 1; expected less than 1";
  }
  SUBCASE("coordinates") {
    material.texture_reads[0].coordinates = 2;
    expected = "/material: coordinates: found index 2; expected less than 2";
  }
  SUBCASE("map") {
    material.texture_reads[0].matrix[1] = kNan;
    expected = "/material: textureReads: found NaN or infinity; expected finite numbers";
  }
  SUBCASE("texture read") {
    material.driven[0].index = 1;
    expected = "/material: driven: found index 1; expected less than 1";
  }
  SUBCASE("primvar") {
    material.driven[1].index = 7;
    expected = "/material: driven: found index 7; expected less than 2";
  }
  SUBCASE("channel") {
    material.driven[1].channel = 3;
    expected = "/material: channel: found 3 and 0 after it; expected less than 3";
  }
  SUBCASE("channels") {
    material.driven[0] = {SurfaceInput::kNormal, DrivenInput::Source::kTexture, 0, 2};
    expected = "/material: channel: found 2 and 2 after it; expected less than 4";
  }
  SUBCASE("twice") {
    material.driven[1].input = SurfaceInput::kRoughness;
    expected = "/material: driven: found an input twice; expected each at most once";
  }
  SUBCASE("share") {
    material.clearcoat = 1.5f;
    expected = "/material: clearcoat: found 1.500000; expected a number from 0 to 1";
  }
  SUBCASE("ior") {
    material.ior = 0.0f;
    expected = "/material: ior: found 0.000000; expected a finite number above 0";
  }
  SUBCASE("specular colour") {
    material.specular_color.x = kNan;
    expected = "/material: specularColor: found NaN or infinity; expected a finite colour";
  }
  SUBCASE("tiles") {
    scene.textures[0].tiles.clear();
    expected = "wood.png: tiles: found 0; expected one";
  }
  SUBCASE("file") {
    scene.textures[0].tiles[0].file.path.clear();
    expected = "wood.png: file: found no path; expected one";
  }
  SUBCASE("fallback") {
    scene.textures[0].fallback[3] = kNan;
    expected = "wood.png: fallback: found NaN or infinity; expected finite numbers";
  }
  SUBCASE("names") {
    scene.primvar_names[1] = "st";
    expected = "scene: primvarNames: found \"st\" twice; expected each once";
  }
  SUBCASE("values") {
    scene.meshes[0].primvars[0].primvar.values.pop_back();
    expected = "/mesh: st: found 3 values; expected 1 keys x 4";
  }
  SUBCASE("no values") {
    scene.meshes[0].primvars[0].primvar.values.clear();
    expected = "/mesh: st: found no values; expected at least one";
  }
  SUBCASE("finite values") {
    scene.meshes[0].primvars[1].primvar.values[0].y = kNan;
    expected = "/mesh: wet: found NaN or infinity in element 0; expected finite values";
  }
  SUBCASE("name") {
    scene.meshes[0].primvars[1].name = 2;
    expected = "/mesh: primvars: found index 2; expected less than 2";
  }
  SUBCASE("a name twice") {
    scene.meshes[0].primvars[1].name = 0;
    expected = "/mesh: primvars: found a name twice; expected each once";
  }
  SUBCASE("of instances") {
    scene.instances[0].primvars[0].values.pop_back();
    expected = "/instances: wet: found 2 values; expected 3";
  }
  SUBCASE("opacity of instances") {
    scene.instances[0].display_opacity = {1.0f};
    expected = "/instances: displayOpacity: found 1 values; expected none or 3";
  }
  CHECK(complaint(scene) == expected);
}

}  // namespace
}  // namespace msbvh
