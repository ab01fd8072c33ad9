// How few keys follow the samples, and that they do: every claim is checked by projecting both in double
// precision.
#include <cmath>
#include <doctest/doctest.h>

#include "core/base/lerp.h"
#include "core/motion/affine_track.h"
#include "core/scene/scene.h"
#include "delegate/translate/transform_samples.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

struct Result {
  std::shared_ptr<const Scene> scene;
  std::vector<Diagnostic> diagnostics;
  TrackReport track;
};

Result translated(const MeshInput& input, const Vec3d& eye,
                  const TranslatorSettings& settings = settings_of()) {
  Translator translator(camera_at(eye), settings);
  translator.add_mesh(input);
  const TrackReport track = translator.tracks().back();
  const std::vector<Diagnostic> diagnostics = translator.diagnostics();
  return {translator.finish(), diagnostics, track};
}

// In the frame's world, whichever way the motion was kept.
Vec3d position(const Scene& scene, std::uint32_t vertex, float u) {
  if (scene.instances.empty()) return Vec3d(scene.meshes.at(0).shape.position(vertex, u));
  const InstanceSet& set = scene.instances[0];
  float inside = u, own = u;
  scene.prototypes[set.prototype].time_remap.at(u, inside);
  set.time_remap.at(u, own);
  const Vec3d p(scene.meshes.at(0).shape.position(vertex, inside));
  return Affine3d(evaluate(set.world_from_prototype, set.form(), own)).point(p);
}

// Pixels from the image's centre, for a camera at the frame's origin.
Vec3d projected(const Vec3d& p, std::uint32_t width = 1000) {
  return {0.5 * width * p.x / -p.z, 0.5 * width * p.y / -p.z, 0.0};
}

// The largest distance, in pixels, of any vertex from where `truth` (stage space) has it, at dense times.
double largest_error(const Result& result, const Vec3d& eye,
                     const std::function<Vec3d(std::uint32_t vertex, double time01)>& truth) {
  double worst = 0.0;
  for (std::uint32_t vertex = 0; vertex < result.scene->meshes.at(0).shape.vertex_count; ++vertex) {
    for (int i = 0; i <= 1000; ++i) {
      const double u = double(float(i / 1000.0));
      const Vec3d found = projected(position(*result.scene, vertex, float(u)));
      worst = std::max(worst, length(found - projected(truth(vertex, u) - eye)));
    }
  }
  return worst;
}

std::vector<Vec3f> moved(std::vector<Vec3f> points, const Vec3f& by) {
  for (Vec3f& p : points) p += by;
  return points;
}

}  // namespace

TEST_SUITE("translate: motion") {
  TEST_CASE("values that do not change over many samples are still") {
    MeshFixture fixture;
    fixture.add_points(0.3, fixture.points[0]);
    fixture.add_points(0.9, fixture.points[0]);
    fixture.transform = sampled([](double) { return rotation(30); }, uniform_times(8));
    const Result result = translated(fixture.input(), {0, 0, 10});
    CHECK(result.track.segments == 0);
    CHECK_FALSE(result.track.moving_transform);
    CHECK(result.scene->world.size() == 1);
    CHECK(result.scene->instances.empty());
  }

  TEST_CASE("linear deformation takes one segment, with bracketing samples outside the shutter") {
    MeshFixture fixture;
    fixture.times01 = {-1.0};
    fixture.add_points(3.0, moved(fixture.points[0], {4, 0, 0}));
    const Result result = translated(fixture.input(), {0, 0, 10});
    CHECK(result.track.segments == 1);
    CHECK(result.track.error_pixels == doctest::Approx(0.0));
    CHECK(position(*result.scene, 0, 0.0f).x == doctest::Approx(1.0));
    CHECK(position(*result.scene, 0, 1.0f).x == doctest::Approx(2.0));
  }

  TEST_CASE("beyond the sampled range the samples hold") {
    MeshFixture fixture;
    fixture.times01 = {0.25};
    fixture.add_points(0.75, moved(fixture.points[0], {1, 0, 0}));
    const Result result = translated(fixture.input(), {0, 0, 10}, linear_settings());
    CHECK(result.track.segments == 4);
    CHECK(position(*result.scene, 0, 0.0f).x == 0.0);
    CHECK(position(*result.scene, 0, 0.25f).x == 0.0);
    CHECK(position(*result.scene, 0, 0.5f).x == doctest::Approx(0.5));
    CHECK(position(*result.scene, 0, 1.0f).x == 1.0);
  }

  TEST_CASE("sample times that are no multiple of 2^-k are followed within the tolerance") {
    MeshFixture fixture;
    const std::vector<Vec3f> rest = fixture.points[0];
    fixture.add_points(0.3, moved(rest, {0, 1, 0}));
    fixture.add_points(1.0, moved(rest, {2, 1, 0}));
    const Vec3d eye{0.5, 0.5, 10};
    const Result result = translated(fixture.input(), eye);
    CHECK(result.track.time_remap);  // under which 0.3 is a key
    CHECK(result.track.segments == 2);
    CHECK(result.track.degree == 1);
    const auto truth = [&](std::uint32_t vertex, double u) {
      const Vec3d a(fixture.points[u < 0.3 ? 0 : 1][vertex]), b(fixture.points[u < 0.3 ? 1 : 2][vertex]);
      return lerp(a, b, u < 0.3 ? u / 0.3 : (u - 0.3) / 0.7);
    };
    CHECK(largest_error(result, eye, truth) < 1e-4);
    CHECK(result.diagnostics.empty());
    validate(*result.scene);
  }

  TEST_CASE("rigid motion stays a still mesh under a moving transform, with the fewest keys that follow it") {
    MeshFixture fixture;
    const auto spin = [](double u) { return rotation(90 * u); };
    fixture.transform = sampled(spin, uniform_times(128));
    const Vec3d eye{0, 0, 10};
    const Result result = translated(fixture.input(), eye, linear_settings());
    CHECK(result.track.moving_transform);
    CHECK(result.scene->world.empty());
    REQUIRE(result.scene->instances.size() == 1);
    CHECK(result.scene->meshes.at(0).shape.segments == 0);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return spin(u).point(Vec3d(fixture.points[0][vertex]));
    };
    CHECK(largest_error(result, eye, truth) <= 0.1);
    // The arc of 90 / n degrees at radius sqrt(2) rises sqrt(2) (1 - cos(45 / n)) above its chord: at 50
    // pixels a unit, and 3 times that at the picture's corner, 0.26 pixels for n = 16 and 0.06 for 32.
    CHECK(result.track.segments == 32);
    CHECK(result.track.error_pixels == doctest::Approx(0.064).epsilon(0.01));
    validate(*result.scene);
  }

  TEST_CASE("deformation under a moving transform is baked and follows both") {
    MeshFixture fixture;
    const std::vector<Vec3f> rest = fixture.points[0];
    fixture.add_points(1.0, moved(rest, {0.5f, 0, 0}));
    const auto spin = [](double u) { return rotation(60 * u); };
    fixture.transform = sampled(spin, uniform_times(64));
    const Vec3d eye{0, 0, 10};
    const Result result = translated(fixture.input(), eye, linear_settings());
    CHECK_FALSE(result.track.moving_transform);
    CHECK(result.track.segments >= 8);
    CHECK(result.track.segments <= 32);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return spin(u).point(lerp(Vec3d(rest[vertex]), Vec3d(fixture.points[1][vertex]), u));
    };
    CHECK(largest_error(result, eye, truth) <= 0.1);
  }

  TEST_CASE("a tighter tolerance takes more keys, a farther object fewer") {
    MeshFixture fixture;
    fixture.transform = sampled([](double u) { return rotation(90 * u); }, uniform_times(128));
    TranslatorSettings tight = settings_of();
    tight.motion_tolerance_pixels = 0.01;
    const std::size_t usual = translated(fixture.input(), {0, 0, 10}).track.bytes;
    CHECK(translated(fixture.input(), {0, 0, 10}, tight).track.bytes > usual);
    CHECK(translated(fixture.input(), {0, 0, 1000}).track.bytes < usual);
  }

  TEST_CASE("too few segments allowed: the most are kept, and a warning names the error") {
    MeshFixture fixture;
    fixture.transform = sampled([](double u) { return rotation(180 * u); }, uniform_times(128));
    TranslatorSettings settings = linear_settings();
    settings.max_segments = 2;
    const Result result = translated(fixture.input(), {0, 0, 10}, settings);
    CHECK(result.track.segments == 2);
    CHECK(result.track.error_pixels > 1.0);
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].severity == Severity::kWarning);
    CHECK(result.diagnostics[0].path == "/mesh");
    CHECK(result.diagnostics[0].message.find("pixels at 2 segments") != std::string::npos);
  }

  TEST_CASE("held samples jump inside the shutter, to the instant; one at its end is not seen") {
    MeshFixture fixture;
    fixture.held = true;
    fixture.add_points(1.0, moved(fixture.points[0], {1, 0, 0}));
    CHECK(translated(fixture.input(), {0, 0, 10}).track.segments == 0);
    for (const double jump : {0.5, 0.3}) {
      fixture.times01[1] = jump;
      const Result result = translated(fixture.input(), {0, 0, 10});
      CHECK(result.track.segments == 4);
      CHECK(result.track.time_remap);
      const auto at = static_cast<float>(jump);
      CHECK(position(*result.scene, 0, 0.0f).x == 0.0);
      CHECK(position(*result.scene, 0, std::nextafterf(at, 0.0f)).x == 0.0);
      CHECK(position(*result.scene, 0, at).x == 1.0);
      CHECK(position(*result.scene, 0, 1.0f).x == 1.0);
      CHECK(result.diagnostics.empty());
      validate(*result.scene);
    }
  }

  TEST_CASE("velocities and accelerations are one quadratic, exactly, and win over samples") {
    MeshFixture fixture;
    fixture.add_points(1.5, moved(fixture.points[0], {100, 0, 0}));
    fixture.times01[0] = 0.25;
    MeshInput input = fixture.input();
    const std::vector<Vec3f> velocities(4, {2, 0, 0}), accelerations(4, {0, -8, 0});
    input.rates.velocities.samples = {{0.25, velocities}, {1.5, velocities}};
    input.rates.accelerations.samples = {{0.25, accelerations}, {1.5, accelerations}};
    input.time_remap = {0.5, 0.5, 1.0f};
    const Vec3d eye{0, 0, 10};
    const Result result = translated(input, eye);
    CHECK(result.track.degree == 2);
    CHECK(result.track.segments == 1);
    CHECK(result.track.source == "accelerations");
    const auto truth = [&](std::uint32_t vertex, double u) {
      const double dt = (u - 0.25) * 0.5;
      return Vec3d(fixture.points[0][vertex]) + Vec3d{2 * dt, -4 * dt * dt, 0};
    };
    CHECK(largest_error(result, eye, truth) < 1e-4);
  }

  TEST_CASE("velocities that do not align, or are too few, do not count, and it is said") {
    MeshFixture fixture;
    fixture.add_points(1.0, moved(fixture.points[0], {1, 0, 0}));
    MeshInput input = fixture.input();
    const std::vector<Vec3f> four(4, {0, 5, 0}), three(3, {0, 5, 0});
    input.time_remap.seconds_per_shutter = 1.0;
    SUBCASE("other times") { input.rates.velocities.samples = {{0.1, four}, {1.0, four}}; }
    SUBCASE("no times at all") {
      input.rates.velocities.samples = {{0.0, four}};
      input.rates.velocities.timeless = true;
    }
    SUBCASE("too few") { input.rates.velocities.samples = {{0.0, three}, {1.0, three}}; }
    const Result result = translated(input, {0, 0, 10});
    CHECK(position(*result.scene, 0, 1.0f).x == 1.0);
    CHECK(position(*result.scene, 0, 1.0f).y == 0.0);
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].attribute == "velocities");
    CHECK(result.diagnostics[0].message.find("not used") != std::string::npos);
  }

  TEST_CASE("a turn takes fewer cubics than chords, and is followed as closely") {
    MeshFixture fixture;
    const auto spin = [](double u) { return rotation(360 * u); };
    fixture.transform = sampled(spin, uniform_times(1024));
    fixture.transform.breakpoints01 = std::vector<double>{};
    const Vec3d eye{0, 0, 10};
    const Result chords = translated(fixture.input(), eye, linear_settings());
    const Result curves = translated(fixture.input(), eye);
    CHECK(chords.track.segments == 128);
    CHECK(curves.track.degree == 3);
    CHECK(3 * curves.track.bytes < chords.track.bytes);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return spin(u).point(Vec3d(fixture.points[0][vertex]));
    };
    CHECK(largest_error(curves, eye, truth) <= 0.1);
  }

  TEST_CASE("forced degrees and segments are kept") {
    MeshFixture fixture;
    fixture.transform = sampled([](double u) { return rotation(20 * u); }, uniform_times(128));
    for (const std::uint32_t degree : {1u, 2u, 3u}) {
      TranslatorSettings settings = settings_of();
      settings.choice = {degree, degree, 8};
      const Result result = translated(fixture.input(), {0, 0, 10}, settings);
      CHECK(result.track.degree == degree);
      CHECK(result.track.segments == 8);
    }
  }

  TEST_CASE("visibility within the shutter becomes a time remap; what is never seen is left out") {
    MeshFixture fixture;
    MeshInput input = fixture.input();
    input.visible = std::vector<VisibleInterval>{{0.25, 0.75}};
    const Result result = translated(input, {0, 0, 10});
    REQUIRE(result.scene->prototypes.size() == 1);
    const TimeRemap& time_remap = result.scene->prototypes[0].time_remap;
    const auto shown = [&](float u) {
      float local;
      return time_remap.at(u, local);
    };
    CHECK_FALSE(shown(0.0f));
    CHECK(shown(0.25f));
    CHECK(shown(std::nextafterf(0.75f, 0.0f)));
    CHECK_FALSE(shown(0.75f));
    CHECK_FALSE(shown(1.0f));
    validate(*result.scene);
    input.visible = std::vector<VisibleInterval>{};
    const Result never = translated(input, {0, 0, 10});
    CHECK(never.scene->world.empty());
    CHECK(never.scene->instances.empty());
  }

  TEST_CASE("a transform that passes through a singular matrix is baked") {
    MeshFixture fixture;
    const auto flip = [](double u) { return Affine3d{{1 - 2 * u, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}; };
    fixture.transform = sampled(flip, {0.0, 0.5, 1.0});
    const Result result = translated(fixture.input(), {0, 0, 10});
    CHECK_FALSE(result.track.moving_transform);
    CHECK(result.track.segments == 1);
    CHECK(position(*result.scene, 1, 0.5f).x == doctest::Approx(0.0));
    CHECK(position(*result.scene, 1, 1.0f).x == doctest::Approx(-1.0));
  }

  TEST_CASE("smooth and authored normals follow a baked rotation") {
    MeshFixture fixture;
    fixture.add_points(1.0, moved(fixture.points[0], {0.5f, 0, 0}));
    // About x, so that the normal of the plane z = 0 turns.
    const auto tumble = [](double u) {
      const double a = u;
      return Affine3d{{1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)}, {}};
    };
    fixture.transform = sampled(tumble, uniform_times(64));
    MeshInput input = fixture.input();
    const std::vector<Vec3f> up{{0, 0, 1}};
    SUBCASE("authored") {
      input.normals.samples = {{0.0, up}};
      input.normals_interpolation = "constant";
    }
    SUBCASE("computed") { input.computed_normals = Normals::kSmooth; }
    const Result result = translated(input, {0, 0, 10});
    const Mesh& mesh = result.scene->meshes.at(0);
    REQUIRE(mesh.normals.authored());
    CHECK(mesh.normals.segments > 0);
    const std::size_t count = mesh.normals.values.size() / key_count(mesh.normals.segments);
    for (int i = 0; i <= 100; ++i) {
      const float u = float(i / 100.0);
      const SegmentTime at = locate(u, mesh.normals.segments);
      const Vec3f n = normalize(
          lerp(mesh.normals.values[at.key * count], mesh.normals.values[(at.key + 1) * count], at.w));
      CHECK(length(Vec3d(n) - Vec3d{0, -std::sin(u), std::cos(u)}) < 0.0101);
    }
    validate(*result.scene);
  }
}

TEST_SUITE("translate: large worlds") {
  // A shot of a scene 1e7 units from the stage's origin: float coordinates are a whole unit apart there.
  const Vec3d kFar{1e7, -2e7, 3e7};
  // 1 unit from the eye, so that 0.1 pixel of 1000 is 0.2 mm if the unit is a metre.
  const Vec3d kEye = kFar + Vec3d{0.25, 0.25, 1.0};

  TEST_CASE("sub-millimetre motion of a transform far from the stage's origin") {
    MeshFixture fixture;
    const auto creep = [&](double u) { return translation(kFar + Vec3d{5e-4 * u, 0, 0}); };
    fixture.transform = sampled(creep, {0.0, 1.0});
    const Result result = translated(fixture.input(), kEye);
    CHECK(result.track.segments == 1);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return creep(u).point(Vec3d(fixture.points[0][vertex]));
    };
    CHECK(largest_error(result, kEye, truth) < 1e-3);
    const double travelled = position(*result.scene, 0, 1.0f).x - position(*result.scene, 0, 0.0f).x;
    CHECK(travelled == doctest::Approx(5e-4).epsilon(1e-3));
  }

  TEST_CASE("sub-millimetre deformation far from the stage's origin") {
    MeshFixture fixture;
    fixture.add_points(1.0, moved(fixture.points[0], {5e-4f, 0, 0}));
    fixture.transform = still(translation(kFar));
    const Result result = translated(fixture.input(), kEye);
    CHECK(result.track.segments == 1);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return kFar + lerp(Vec3d(fixture.points[0][vertex]), Vec3d(fixture.points[1][vertex]), u);
    };
    CHECK(largest_error(result, kEye, truth) < 1e-3);
  }

  TEST_CASE("points that are large themselves and brought back by a moving transform") {
    // Exact in float: multiples of 4 near 3e7.
    MeshFixture fixture;
    const Vec3f corner{3e7f, -3e7f, 3e7f};
    fixture.points[0] = moved({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, corner);
    const auto creep = [&](double u) { return translation(Vec3d{5e-4 * u, 0, -4.0} - Vec3d(corner)); };
    fixture.transform = sampled(creep, {0.0, 1.0});
    const Result result = translated(fixture.input(), {});
    CHECK(result.track.moving_transform);
    const auto truth = [&](std::uint32_t vertex, double u) {
      return creep(u).point(Vec3d(fixture.points[0][vertex]));
    };
    CHECK(largest_error(result, {}, truth) < 1e-3);
  }
}
