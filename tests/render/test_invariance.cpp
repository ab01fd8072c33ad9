// What must not change the picture.
#include <random>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 50;  // not a multiple of the tile
const RenderSettings kSettings{.width = kSize, .height = kSize, .spp = 8, .max_bounces = 2, .build = {}};

// Long thin triangles that turn and drift, as a mesh with still vertices and the keys of its motion.
struct Sticks {
  Mesh mesh;
  std::vector<Affine3f> keys;
};

Sticks sticks(std::uint32_t segments) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0.0f, kSize), offset(-15.0f, 15.0f);
  Sticks out;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3f a{place(random), place(random), place(random)};
    const Vec3f b = a + Vec3f{offset(random), offset(random), offset(random)};
    const std::vector<Vec3f> corners{a, b, b + Vec3f{0.5f, 0.5f, 0.5f}};
    out.mesh.shape.positions.insert(out.mesh.shape.positions.end(), corners.begin(), corners.end());
    out.mesh.shape.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  out.mesh.shape.vertex_count = 900;
  out.mesh.display_color.values = {{0.7f, 0.6f, 0.5f}};
  for (std::uint32_t i = 0; i < key_count(segments); ++i) {
    const float angle = 0.1f * static_cast<float>(i), c = std::cos(angle), s = std::sin(angle);
    out.keys.push_back({{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {2.0f * static_cast<float>(i), 0, 0}});
  }
  return out;
}

Scene lit_scene() {
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  Light sun;
  sun.name = "/sun";
  sun.world_from_light = {Affine3f{}};
  sun.angle_degrees = 20.0f;
  scene.lights = {sun, dome({0.3f, 0.4f, 0.5f})};
  return scene;
}

Scene moving_scene() {
  const Sticks all = sticks(4);
  Scene scene = lit_scene();
  add(scene, baked(all.mesh, all.keys));
  return scene;
}

// Pixels that differ by more than rounding explains.
std::size_t differing_pixels(const Image& a, const Image& b, float tolerance) {
  REQUIRE(a.rgba.size() == b.rgba.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    bool differs = false;
    for (int c = 0; c < 4; ++c) differs |= !(std::abs(a.rgba[i + c] - b.rgba[i + c]) <= tolerance);
    count += differs;
  }
  return count;
}

TEST_CASE("the same seed gives the same bits on any number of threads; another seed does not") {
  const Scene scene = moving_scene();
  RenderSettings settings = kSettings;
  settings.threads = 1;
  const Image one = render(scene, settings);
  settings.threads = 2;
  CHECK(render(scene, settings).rgba == one.rgba);
  settings.threads = 0;
  CHECK(render(scene, settings).rgba == one.rgba);
  settings.seed = 1;
  CHECK(render(scene, settings).rgba != one.rgba);
}

// Ties go to the lowest ids, whatever the tree: not a bit differs.
TEST_CASE("MBVH and MSBVH give the same picture") {
  const Scene scene = moving_scene();
  RenderSettings settings = kSettings;
  const Image spatial = render(scene, settings);
  settings.build.builder = Builder::kMbvh;
  CHECK(render(scene, settings).rgba == spatial.rgba);
}

// Both interpolate the same keys, one the vertices and one the matrix: rounding differs, and with it a few of
// the 20,000 samples, by at most one sample's share each.
TEST_CASE("an instance and the same object baked") {
  for (const std::uint32_t segments : {0u, 1u, 4u}) {
    CAPTURE(segments);
    const Sticks all = sticks(segments);
    Scene in_world = lit_scene(), instanced = lit_scene();
    add(in_world, baked(all.mesh, all.keys));
    add_instance(instanced, all.mesh, all.keys);
    const Image a = render(in_world, kSettings), b = render(instanced, kSettings);
    CHECK(differing_pixels(a, b, 1e-3f) <= kSize * kSize / 500);
  }
}

TEST_CASE("keys that lie on the chord of their neighbours change nothing but rounding") {
  const Sticks all = sticks(1);
  Scene few = lit_scene(), many = lit_scene();
  add(few, baked(all.mesh, all.keys));
  add(many, baked(all.mesh,
                  {all.keys[0], lerp(all.keys[0], all.keys[1], 0.25f), lerp(all.keys[0], all.keys[1], 0.5f),
                   lerp(all.keys[0], all.keys[1], 0.75f), all.keys[1]}));
  CHECK(differing_pixels(render(few, kSettings), render(many, kSettings), 1e-3f) <= kSize * kSize / 500);
}

TEST_CASE("an effect elsewhere in the scene does not change the noise of the rest") {
  const Scene plain = moving_scene();
  const Image before = render(plain, kSettings);
  Scene more = plain;
  SUBCASE("opacity, an instance, a moving mesh: behind the camera's back") {
    Mesh mesh = polygon({rectangle(0, 0, 1, 1, 1e6f), rectangle(1, 0, 2, 1, 1e6f)});
    mesh.display_opacity.values = {0.5f};
    add_instance(more, mesh, {translation({}), translation({0, 1, 0})});
  }
  SUBCASE("a light that does not shine") {
    more.lights.push_back(camera_light());
    more.lights.back().radiance = {};
  }
  CHECK(render(more, kSettings).rgba == before.rgba);
}

}  // namespace
}  // namespace msbvh
