// What moves outside of the picture throughout the shutter takes fewer keys, and nothing else does.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <memory>

#include "core/scene/scene.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

const Vec3d kOutside{40, 0, 0}, kInside{0, 0, 0}, kBehind{0, 0, 60};
constexpr int kIntervals = 128;

Motion spinning(const Vec3d& place, double degrees = 120.0) {
  return [=](double u) {
    Affine3d map = rotation(degrees * u);
    map.t = place;
    return map;
  };
}

TranslatorSettings with_factor(double factor) {
  TranslatorSettings settings = settings_of();
  settings.outside_tolerance = factor;
  return settings;
}

CameraInput camera() { return camera_at({0, 0, 10}); }

struct Found {
  TrackReport track;
  std::shared_ptr<const Scene> scene;
  std::vector<Diagnostic> said;
};

Found finished(Translator& translator) {
  Found found{translator.tracks().back(), nullptr, translator.diagnostics()};
  found.scene = translator.finish();
  validate(*found.scene);
  return found;
}

Found rigid(const Motion& motion, double factor, const CameraInput& from = camera()) {
  MeshFixture quad;
  quad.transform = sampled(motion, uniform_times(kIntervals));
  Translator translator(from, with_factor(factor));
  translator.add_mesh(quad.input());
  return finished(translator);
}

// The same motion, of points.
MeshFixture moved_points(const Motion& motion) {
  MeshFixture quad;
  const std::vector<Vec3f> corners = quad.points.front();
  quad.times01.clear();
  quad.points.clear();
  for (const double time01 : uniform_times(kIntervals)) {
    std::vector<Vec3f> points;
    for (const Vec3f& corner : corners) points.push_back(Vec3f(motion(time01).point(Vec3d(corner))));
    quad.add_points(time01, points);
  }
  return quad;
}

Found deforming(const Motion& motion, double factor) {
  MeshFixture quad = moved_points(motion);
  Translator translator(camera(), with_factor(factor));
  translator.add_mesh(quad.input());
  return finished(translator);
}

std::unique_ptr<Translator> placing(const std::vector<Motion>& motions, const TranslatorSettings& settings,
                                    std::vector<std::string> paths) {
  auto translator = std::make_unique<Translator>(camera(), settings);
  const std::uint32_t prototype = translator->begin_prototype("/prototype");
  translator->add_prototype_mesh(prototype, MeshFixture().input());
  const std::vector<double> times01 = uniform_times(kIntervals);
  std::vector<Matrix4d> matrices;
  for (const double time01 : times01) {
    for (const Motion& motion : motions) matrices.push_back(row_vector_matrix(motion(time01)));
  }
  InstancesInput input = instances_of("/instances", prototype, times01, matrices);
  input.paths = std::move(paths);
  translator->add_instances(input);
  return translator;
}

Found instances(const std::vector<Motion>& motions, double factor) {
  return finished(*placing(motions, with_factor(factor), {}));
}

void check_same(const Found& a, const Found& b) {
  CHECK(a.track.controls() == b.track.controls());
  CHECK(a.track.error_pixels == b.track.error_pixels);
  CHECK(a.track.tolerance_pixels == 0.1);
  CHECK(a.track.outside == 0);
  CHECK(a.track.keys_saved == 0);
}

void check_coarser(const Found& coarse, const Found& fine) {
  CHECK(coarse.said.empty());
  CHECK(coarse.track.controls() < fine.track.controls());
  CHECK(coarse.track.keys_saved == fine.track.controls() - coarse.track.controls());
  CHECK(coarse.track.coarser == 1);
  CHECK(coarse.track.outside == 1);
  CHECK(coarse.track.error_outside);
  CHECK(coarse.track.tolerance_pixels == doctest::Approx(0.8));
  CHECK(coarse.track.error_pixels <= 0.8);
  CHECK(coarse.track.bytes < fine.track.bytes);
  CHECK(fine.track.outside == 0);
  CHECK(fine.track.error_pixels <= 0.1);
}

LightInput dome() {
  LightInput input;
  input.light.name = "/dome";
  input.light.kind = LightKind::kDome;
  input.light.radiance = {1, 1, 1};
  input.world_from_light = still();
  return input;
}

// Camera-space lens of a radius, focused at the distance of the subjects.
CameraInput with_lens(float radius) {
  CameraInput result = camera();
  result.samples.front().lens = {radius, 3.0f};
  return result;
}

}  // namespace

TEST_SUITE("translate: outside of the picture") {
  TEST_CASE("what moves beside or behind the picture takes fewer keys, within its own tolerance") {
    for (const Vec3d& place : {kOutside, kBehind}) {
      check_coarser(rigid(spinning(place), 8.0), rigid(spinning(place), 1.0));
      check_coarser(deforming(spinning(place), 8.0), deforming(spinning(place), 1.0));
      check_coarser(instances({spinning(place)}, 8.0), instances({spinning(place)}, 1.0));
    }
    // So does the geometry that carries the keys.
    CHECK(deforming(spinning(kOutside), 8.0).scene->meshes[0].shape.positions.size() <
          deforming(spinning(kOutside), 1.0).scene->meshes[0].shape.positions.size());
  }

  TEST_CASE("what is in the picture keeps its keys, whatever the factor") {
    check_same(rigid(spinning(kInside), 8.0), rigid(spinning(kInside), 1.0));
    check_same(deforming(spinning(kInside), 8.0), deforming(spinning(kInside), 1.0));
    check_same(instances({spinning(kInside)}, 8.0), instances({spinning(kInside)}, 1.0));
    // Within a tenth of its width beside it, which filters may reach: 10 units are a half of it.
    check_same(rigid(spinning({11.0, 0, 0}), 8.0), rigid(spinning({11.0, 0, 0}), 1.0));
  }

  TEST_CASE("what crosses the picture within the shutter keeps its keys, though it is outside at both ends") {
    const Motion crossing = [](double u) {
      Affine3d map = rotation(120.0 * u);
      map.t = {40.0 - 80.0 * u, 0, 0};
      return map;
    };
    check_same(rigid(crossing, 8.0), rigid(crossing, 1.0));
    check_same(deforming(crossing, 8.0), deforming(crossing, 1.0));
    check_same(instances({crossing}, 8.0), instances({crossing}, 1.0));
  }

  TEST_CASE("what the camera passes within the shutter keeps its keys") {
    CameraInput passing = camera();
    passing.samples.clear();
    for (const double time01 : uniform_times(16)) {
      // There and back, so that both ends and the middle of the shutter look elsewhere.
      const double x = 40.0 * std::abs(std::sin(2.0 * std::numbers::pi * time01));
      passing.samples.push_back({time01, row_vector_matrix(translation({x, 0, 10})), ScreenWindow{}});
    }
    check_same(rigid(spinning(kOutside), 8.0, passing), rigid(spinning(kOutside), 1.0, passing));
    const Vec3d elsewhere{0, 60, 0};
    check_coarser(rigid(spinning(elsewhere), 8.0, passing), rigid(spinning(elsewhere), 1.0, passing));
  }

  TEST_CASE("what a lens blurs into the picture keeps its keys") {
    const Motion beside = spinning({16, 0, 0}, 75.0);
    check_coarser(rigid(beside, 8.0), rigid(beside, 1.0));
    check_same(rigid(beside, 8.0, with_lens(3.0f)), rigid(beside, 1.0, with_lens(3.0f)));
  }

  TEST_CASE("instances are judged one by one; the report is of those in the picture") {
    const std::vector<Motion> both{spinning(kInside), spinning(kOutside), spinning(kOutside)};
    const Found coarse = instances(both, 8.0), fine = instances(both, 1.0);
    CHECK(coarse.said.empty());
    CHECK(coarse.track.count == 3);
    CHECK(coarse.track.outside == 2);
    CHECK(coarse.track.coarser == 2);
    CHECK(coarse.track.keys_saved > 0);
    CHECK_FALSE(coarse.track.error_outside);
    CHECK(coarse.track.tolerance_pixels == 0.1);
    CHECK(coarse.track.error_pixels == instances({spinning(kInside)}, 1.0).track.error_pixels);
    CHECK(coarse.track.bytes == fine.track.bytes - coarse.track.keys_saved * sizeof(Affine3f));
    REQUIRE(coarse.scene->instances.size() == 2);
    const auto& sets = coarse.scene->instances;
    CHECK(sets[0].form().controls() < sets[1].form().controls());
    CHECK(sets[1].world_from_prototype.size() == sets[1].form().controls());  // one, the one that is seen
  }

  TEST_CASE("prims with reports of their own are counted once") {
    Translator translator(camera(), with_factor(8.0));
    const std::uint32_t prototype = translator.begin_prototype("/prototype");
    translator.add_prototype_mesh(prototype, MeshFixture().input());
    const std::vector<double> times01 = uniform_times(kIntervals);
    std::vector<Matrix4d> matrices;
    for (const double time01 : times01) {
      matrices.push_back(row_vector_matrix(spinning(kInside)(time01)));
      matrices.push_back(row_vector_matrix(spinning(kOutside)(time01)));
    }
    InstancesInput input = instances_of("/instances", prototype, times01, matrices);
    input.paths = {"/inside", "/outside"};
    input.report_whole = true;
    translator.add_instances(input);
    const std::vector<TrackReport>& tracks = translator.tracks();
    REQUIRE(tracks.size() == 5);  // after the camera's and the prototype's
    CHECK(tracks[2].outside == 0);
    CHECK(tracks[2].tolerance_pixels == 0.1);
    CHECK(tracks[3].coarser == 1);
    CHECK(tracks[3].error_outside);
    CHECK(tracks[3].tolerance_pixels == doctest::Approx(0.8));
    CHECK(tracks[4].path == "/instances");
    CHECK(tracks[4].keys_saved == 0);
  }

  TEST_CASE("a prim counts the places where it stands, and those outside of the picture among them") {
    const std::vector<Motion> places{spinning(kInside), spinning(kOutside), spinning(kOutside)};
    const auto translator = placing(places, with_factor(8.0), {"/prim"});
    const std::vector<TrackReport>& tracks = translator->tracks();
    REQUIRE(tracks.size() == 3);
    CHECK(tracks[1].count == 0);  // the prototype's mesh
    CHECK(tracks[2].path == "/prim");
    CHECK(tracks[2].count == 3);
    CHECK(tracks[2].outside == 2);
  }

  TEST_CASE("what is left out is not among the coarser tracks; what stands beside it is") {
    for (const bool prims : {false, true}) {
      std::vector<std::string> paths;
      if (prims) paths = {"/first", "/second"};
      const std::vector<Motion> motions{spinning(kInside), spinning(kOutside)};
      TranslatorSettings settings = with_factor(8.0);
      settings.max_bounces = 0;
      const auto translator = placing(motions, settings, paths);
      CHECK(translator->tracks().back().coarser == 1);
      const auto scene = translator->finish();
      CHECK(scene->instances.size() == 1);
      REQUIRE(translator->left_out().size() == 1);
      for (const TrackReport& track : translator->tracks()) {
        CHECK(track.coarser == 0);
        CHECK(track.keys_saved == 0);
      }
      settings.max_bounces = 1;
      const auto bounced = placing(motions, settings, paths);
      bounced->add_light(dome());
      bounced->finish();
      CHECK(bounced->left_out().empty());
      CHECK(bounced->tracks().back().coarser == 1);
      CHECK(bounced->tracks().back().outside == 1);
    }
  }

  TEST_CASE("meshes that are left out are not among the coarser tracks") {
    for (const bool deforms : {false, true}) {
      for (const std::uint32_t bounces : {0u, 1u}) {
        MeshFixture quad;
        if (deforms) quad = moved_points(spinning(kOutside));
        if (!deforms) quad.transform = sampled(spinning(kOutside), uniform_times(kIntervals));
        TranslatorSettings settings = with_factor(8.0);
        settings.max_bounces = bounces;
        Translator translator(camera(), settings);
        if (bounces > 0) translator.add_light(dome());
        translator.add_mesh(quad.input());
        translator.finish();
        CHECK(translator.left_out().size() == (bounces == 0 ? 1 : 0));
        CHECK(translator.tracks().back().coarser == bounces);
      }
    }
  }

  TEST_CASE("what is seen and what is not are said apart, each with its own worst and tolerance") {
    const Motion slow = spinning(kInside, 360.0 * 10);
    std::vector<Motion> motions{slow, spinning(kOutside, 360.0 * 40), spinning(kOutside, 360.0 * 30)};
    TranslatorSettings settings = with_factor(8.0);
    settings.max_segments = 2;
    const std::vector<Diagnostic> said = placing(motions, settings, {})->diagnostics();
    REQUIRE(said.size() == 2);
    CHECK(said[0].message.find("the motion of 1 of 3 instances deviates") != std::string::npos);
    CHECK(said[0].message.find("expected at most 0.1;") != std::string::npos);
    CHECK(said[1].message.find("the motion of 2 of 3 instances outside of the picture deviates") !=
          std::string::npos);
    CHECK(said[1].message.find("expected at most 0.8;") != std::string::npos);
    const auto error_of = [](const Diagnostic& diagnostic) {
      return diagnostic.message.substr(diagnostic.message.find("up to "));
    };
    const auto alone = [&](std::size_t i) {
      return placing({motions[i]}, settings, {})->diagnostics().at(0);
    };
    CHECK(error_of(said[0]) == error_of(alone(0)));
    const double worst = std::max(placing({motions[1]}, settings, {})->tracks().back().error_pixels,
                                  placing({motions[2]}, settings, {})->tracks().back().error_pixels);
    CHECK(said[1].message.find(message("up to ", worst, " pixels")) != std::string::npos);
    const std::vector<Diagnostic> of_prim = placing(motions, settings, {"/prim"})->diagnostics();
    REQUIRE(of_prim.size() == 2);
    CHECK(of_prim[0].message.find("the motion deviates") != std::string::npos);
    CHECK(of_prim[1].message.find("the motion outside of the picture deviates") != std::string::npos);
  }

  TEST_CASE("what misses even the coarser tolerance is said, with that tolerance") {
    const Motion whirl = spinning(kOutside, 360.0 * 40);
    TranslatorSettings settings = with_factor(8.0);
    settings.max_segments = 2;
    MeshFixture quad;
    quad.transform = sampled(whirl, uniform_times(16 * kIntervals));
    Translator translator(camera(), settings);
    translator.add_mesh(quad.input());
    const Found found = finished(translator);
    REQUIRE(found.said.size() == 1);
    CHECK(found.said[0].message.find("expected at most 0.8;") != std::string::npos);
    CHECK(found.track.error_pixels > found.track.tolerance_pixels);
  }

  TEST_CASE("a given number of segments is that of all") {
    TranslatorSettings settings = with_factor(8.0);
    settings.choice.segments = 4;
    MeshFixture quad;
    quad.transform = sampled(spinning(kOutside), uniform_times(kIntervals));
    Translator translator(camera(), settings);
    translator.add_mesh(quad.input());
    const Found found = finished(translator);
    CHECK(found.track.segments == 4);
    CHECK(found.track.outside == 0);
  }

  TEST_CASE("a factor that makes no sense is refused") {
    for (const double factor : {0.5, 0.0, -8.0, std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity()}) {
      CHECK_THROWS_WITH(Translator(camera(), with_factor(factor)),
                        doctest::Contains("outside tolerance: found"));
    }
  }
}
