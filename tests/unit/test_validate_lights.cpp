// The gate of lights.
#include <cmath>
#include <doctest/doctest.h>

#include "tests/unit/valid_scene.h"

namespace msbvh {
namespace {

TEST_CASE("lights: tracks and sizes") {
  Scene scene = valid_scene();
  Light& light = scene.lights[0];
  SUBCASE("track") {
    light.segments = 4;
    CHECK(complaint(scene) == "/light: worldFromLight: found 1 keys; expected 5");
  }
  SUBCASE("a dome needs no transform") {
    light.kind = LightKind::kDome;
    light.world_from_light.clear();
    CHECK(complaint(scene) == "");
  }
  SUBCASE("values by key") {
    light.moving_values.resize(2);
    CHECK(complaint(scene) == "/light: radiance: found 2 keys; expected none or 1");
    light.moving_values.resize(1);
    CHECK(complaint(scene) == "");
    light.moving_values[0].radiance.x = kNan;
    CHECK(complaint(scene).find("/light: radiance: found NaN") == 0);
  }
  SUBCASE("a point that becomes a sphere") {
    light.kind = LightKind::kSphere;
    light.segments = 1;
    light.world_from_light.resize(2);
    light.moving_values.resize(2);
    light.moving_values[0].radius = 0.0f;
    CHECK(complaint(scene) == "/light: radius: found 0 at some keys only; expected 0 at all keys or at none");
  }
  SUBCASE("angle") {
    light.angle_degrees = -1.0f;
    CHECK(complaint(scene) == "/light: angle: found -1.000000; expected 0 to 360 degrees");
  }
  SUBCASE("radius") {
    light.kind = LightKind::kSphere;
    light.radius = -1.0f;
    CHECK(complaint(scene) == "/light: radius: found -1.000000; expected a finite number of at least 0");
  }
}

TEST_CASE("lights: what shapes them, their images, shadows and links") {
  Scene scene = valid_scene();
  Light& light = scene.lights[0];
  SUBCASE("length") {
    light.kind = LightKind::kCylinder;
    light.length = -2.0f;
    CHECK(complaint(scene) == "/light: length: found -2.000000; expected a finite number of at least 0");
  }
  SUBCASE("disk") {
    light.kind = LightKind::kDisk;
    light.radius = kNan;
    CHECK(complaint(scene) == "/light: radius: found nan; expected a finite number of at least 0");
  }
  SUBCASE("softness") {
    light.cone_softness = 1.5f;
    CHECK(complaint(scene) == "/light: coneSoftness: found 1.500000; expected 0 to 1");
  }
  SUBCASE("diffuse") {
    light.diffuse = kNan;
    CHECK(complaint(scene) == "/light: diffuse: found nan; expected a finite number of at least 0");
  }
  SUBCASE("an image of another kind of light") {
    light.image = light_image("sky", ImageMap::kLatlong, 1, 1, {{1, 1, 1}});
    CHECK(complaint(scene) ==
          "/light: image: found a dome's; expected an image of a rect on a rect, and of a dome on a dome");
    light.kind = LightKind::kDome;
    CHECK(complaint(scene) == "");
    light.world_from_light.clear();
    CHECK(complaint(scene) == "/light: worldFromLight: found 0 keys; expected 1");
  }
  SUBCASE("an image without its shares") {
    light.kind = LightKind::kDome;
    LightImage image;
    image.width = image.height = 1;
    image.texels.resize(1);
    light.image = std::make_shared<const LightImage>(image);
    CHECK(complaint(scene) == "/light: image: found 1 texels; expected one at least, by light_image()");
  }
  SUBCASE("IES") {
    IesProfile profile;
    profile.vertical = {0, 90};
    profile.horizontal = {0, 360};
    profile.candela = {1, 1, 1};
    light.ies.profile = std::make_shared<const IesProfile>(profile);
    CHECK(complaint(scene) ==
          "/light: ies: found 3 intensities for 2 x 2 angles; expected one for each pair of two "
          "angles at least");
    profile.candela = {1, 1, 1, 1};
    profile.horizontal = {360, 0};
    light.ies.profile = std::make_shared<const IesProfile>(profile);
    CHECK(complaint(scene) == "/light: ies: found angles that do not increase; expected increasing angles");
  }
  SUBCASE("shadow") {
    light.shadow.falloff_gamma = 0.0f;
    CHECK(complaint(scene) ==
          "/light: shadow falloffGamma: found 0.000000; expected a finite number above 0");
    light.shadow = {};
    light.shadow.color.x = kNan;
    CHECK(complaint(scene) == "/light: shadow colour: found NaN or infinity; expected a finite colour");
  }
  SUBCASE("links") {
    scene.meshes[0].light_group = 2;
    light.lit_groups = {1, 0};
    CHECK(complaint(scene) == "/light: link: found 2 groups; expected none or 3");
    light.lit_groups = {1, 0, 1};
    CHECK(complaint(scene) == "");
    scene.instances[0].light_groups = {0};
    CHECK(complaint(scene) == "/instances: lightGroups: found 1 values; expected none or 3");
  }
}

}  // namespace
}  // namespace msbvh
