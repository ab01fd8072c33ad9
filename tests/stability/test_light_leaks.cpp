// No ray that bounces about in a closed shell gets out of it: docs/design/watertight.md, section 4.
#include <atomic>
#include <string>

#include "core/base/parallel.h"
#include "tests/stability/shells.h"
#include "tests/stability/walker.h"
#include "tests/support/soak.h"

namespace msbvh {
namespace {
using namespace pictures;
using namespace shells;

// Just above a power of two, where single precision is coarsest.
constexpr float kFar = 1026.0f, kFarther = 8200.0f;

const Shell kShells[] = {
    {.name = "still"},
    {.name = "still, large", .rings = 12, .scale = 1e3f},
    {.name = "still, far from the origin", .place = kFar},
    {.name = "tetrahedra", .solid = Solid::kTetra},
    {.name = "tetrahedra, tiny", .solid = Solid::kTetra, .scale = 1e-4f},
    {.name = "crossing itself", .solid = Solid::kTangle},
    {.name = "2 keys", .form = {1, 1}},
    {.name = "9 keys, far", .form = {8, 1}, .scale = 10.0f, .place = kFarther},
    {.name = "a cubic", .form = {1, 3}},
    {.name = "resting instance, far", .place = kFarther, .instanced = true, .resting = true},
    {.name = "moving instance", .instanced = true},
    {.name = "moving instance of a moving mesh, far", .form = {2, 1}, .place = kFar, .instanced = true},
};

constexpr std::uint64_t kPathsAShell = 256;  // then the next shell of the kind

// `aimed`: the share of the rays that head for an edge or a corner.
Tally walk_shells(const Shell& shell, float aimed, std::uint64_t paths) {
  const std::size_t count = (paths + kPathsAShell - 1) / kPathsAShell;
  std::vector<Tally> tallies(count);
  parallel_for(count, [&](std::size_t i) {
    const Trap trap(shell, i + 1);
    Walker<Trap> walker(trap, aimed, i + 1000);
    for (std::uint64_t path = 0; path < kPathsAShell; ++path) walker.walk();
    tallies[i] = walker.tally();
  });
  Tally sum;
  for (const Tally& t : tallies) sum += t;
  return sum;
}

// The share of bounces that may end for want of a place to go on from, where rays go in random directions.
// Those are hits next to an edge by rays that come along the face that meets there, from far.
constexpr double kMayEnd = 1e-6;

Tally check_shells(float aimed, std::uint64_t rays) {
  constexpr std::uint64_t kRaysAPath = 1 + kBounces * (kProbes + 1);
  Tally all;
  for (const Shell& shell : kShells) {
    CAPTURE(std::string(shell.name));
    const Tally tally = walk_shells(shell, aimed, rays / std::size(kShells) / kRaysAPath + 1);
    CHECK(tally.escaped == 0);
    CHECK(tally.looked > 0);
    if (std::getenv("MSBVH_TEST_FIGURES"))
      MESSAGE(std::string(shell.name), ": ", tally.rays, " rays, ", tally.escaped, " escaped; of ",
              tally.bounces, " bounces ", tally.looked, " looked at neighbours, ", tally.ended, " ended");
    all += tally;
  }
  return all;
}

// A camera inside the shell, and lights outside that shine on it from everywhere.
Scene dark_room(const Shell& shell, std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  const Vec3f place{shell.place, -shell.place, shell.place};
  add(scene, shell_mesh(shell, random, place));
  scene.meshes[0].display_color.values = {{0.9f, 0.9f, 0.9f}};
  scene.camera.projection = Projection::kPerspective;
  scene.camera.world_from_camera = {translation(place)};
  scene.camera.window = {{-2, 2, -2, 2}};
  scene.camera.near_clip = 1e-4f;
  Light sun;
  sun.world_from_light = {Affine3f{}};
  sun.radiance = {1e6f, 1e6f, 1e6f};
  scene.lights = {sun, dome({1e6f, 1e6f, 1e6f})};
  return scene;
}

std::size_t lit_pixels(const Scene& scene) {
  const Image image = render(scene, {.width = 32, .height = 32, .spp = 8, .max_bounces = 4, .build = {}});
  std::size_t lit = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) lit += image.rgba[i] != 0.0f;
  return lit;
}

// So far from the origin that a good part of the hits are next to an edge, in single precision.
TEST_CASE("a closed shell is black inside, whatever shines on it from outside") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const TrackForm form : {TrackForm{}, TrackForm{1, 1}}) {
      Scene scene = dark_room({.name = "dark", .rings = 16, .form = form, .place = 1e3f}, seed);
      CHECK(lit_pixels(scene) == 0);
      // Through a veil: the ray goes on straight behind it.
      const Vec3f eye = scene.camera.world_from_camera[0].t;
      Mesh veil = baked(cube(), {Affine3f{{0.02f, 0, 0}, {0, 0.02f, 0}, {0, 0, 0.02f}, eye}});
      veil.display_opacity.values = {0.25f};
      add(scene, veil);
      CHECK(lit_pixels(scene) == 0);
    }
  }
}

// Nothing hides the dome from a convex body: each sample has the albedo times its radiance, exactly. The
// triangles are so small, for where they are, that most hits are next to an edge.
TEST_CASE("next to edges a convex body is as bright as elsewhere") {
  const float place = 1000.0f;
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  scene.camera.world_from_camera[0].t += Vec3f{place, place, 0};
  scene.lights = {dome({1, 1, 1})};
  Mesh ball;
  ball.shape = procedural::sphere(96);
  ball = baked(ball, {Affine3f{{14, 0, 0}, {0, 14, 0}, {0, 0, 14}, {place + 16, place + 16, 0}}});
  ball.display_color.values = {{0.5f, 0.5f, 0.5f}};
  add(scene, ball);
  const Image image = render(scene, {.width = 32, .height = 32, .spp = 16, .max_bounces = 0, .build = {}});
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float alpha = image.rgba[i + kAlpha];
    REQUIRE(image.rgba[i] == doctest::Approx(0.5 * alpha + 1.0 * (1 - alpha)).epsilon(1e-5));
  }
}

TEST_CASE("in a closed shell that emits, each bounce adds the albedo's next power: none is lost in corners") {
  Scene scene = dark_room({.name = "furnace"}, 3);
  scene.lights.clear();
  scene.meshes[0].material = 0;
  scene.materials.resize(1);
  scene.materials[0].diffuse_color = {0.5f, 0.5f, 0.5f};
  scene.materials[0].emissive_color = {1, 1, 1};
  const Image image = render(scene, {.width = 32, .height = 32, .spp = 64, .max_bounces = 4, .build = {}});
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    REQUIRE(image.rgba[i] == doctest::Approx(1.9375).epsilon(1e-5));
  }
}

TEST_SUITE("slow") {
  TEST_CASE("soak: no ray gets out of a closed shell") {
    Tally all = check_shells(0.5f, test::soak_count(1'000'000, 57'000'000));
    const Tally at_random = check_shells(0.0f, test::soak_count(1'000'000, 52'000'000));
    CHECK(double(at_random.ended) <= 1.0 + kMayEnd * double(at_random.bounces));
    all += at_random;
    test::soak_figure("light leaks", std::to_string(all.rays) + " rays in closed shells, " +
                                         std::to_string(all.escaped) + " escaped; " +
                                         std::to_string(at_random.ended) + " of " +
                                         std::to_string(at_random.bounces) + " bounces ended");
  }
}

}  // namespace
}  // namespace msbvh
