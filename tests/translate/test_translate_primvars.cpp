// Primvars whose values change inside the shutter.
#include <cmath>
#include <deque>
#include <doctest/doctest.h>
#include <limits>

#include "core/scene/scene.h"
#include "core/shade/primvar.h"
#include "delegate/translate/primvar_track.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

// The quad of MeshFixture with opacities over the shutter.
struct Painted {
  MeshFixture quad;
  std::deque<std::vector<float>> values;
  std::vector<double> times01;
  std::vector<int> indices;
  std::string interpolation = "vertex";
  std::vector<Diagnostic> diagnostics;

  void add(double time01, std::vector<float> sample) {
    times01.push_back(time01);
    values.push_back(std::move(sample));
  }
  Primvar<float> translated(std::uint32_t max_segments = kMaxSegments) {
    MeshInput input = quad.input();
    input.display_opacity.interpolation = interpolation;
    input.display_opacity.values = values.front();
    input.display_opacity.indices = indices;
    for (std::size_t i = 0; i < values.size(); ++i) {
      input.display_opacity.samples.push_back({times01[i], values[i]});
    }
    TranslatorSettings settings = settings_of();
    settings.max_segments = max_segments;
    Translator translator(camera_at({0, 0, 5}), settings);
    translator.add_mesh(input);
    diagnostics = translator.diagnostics();
    const auto scene = translator.finish();
    validate(*scene);
    return scene->meshes.at(0).display_opacity;
  }
};

// Of element `i` at a time.
double at(const Primvar<float>& primvar, std::size_t i, double time01) {
  const std::size_t count = primvar.values.size() / key_count(primvar.segments);
  const SegmentTime place = locate(float(time01), primvar.segments);
  const double first = primvar.values[place.key * count + i];
  return primvar.segments == 0
             ? first
             : (1 - place.w) * first + place.w * primvar.values[(place.key + 1) * count + i];
}

}  // namespace

TEST_SUITE("translate: primvars") {
  TEST_CASE("a ramp takes one segment and is exact, also between samples outside the shutter") {
    Painted mesh;
    mesh.add(-1.0, {0.0f, 0.5f, 1.0f, 0.25f});
    mesh.add(3.0, {1.0f, 0.5f, 0.0f, 0.75f});
    const Primvar<float> opacity = mesh.translated();
    CHECK(mesh.diagnostics.empty());
    CHECK(opacity.segments == 1);
    CHECK(opacity.values == std::vector<float>{0.25f, 0.5f, 0.75f, 0.375f, 0.5f, 0.5f, 0.5f, 0.5f});
  }

  TEST_CASE("interpolation and indices expand every key") {
    Painted mesh;
    SUBCASE("uniform") {
      mesh.interpolation = "uniform";
      mesh.add(0.0, {0.0f});
      mesh.add(1.0, {1.0f});
      CHECK(mesh.translated().values == std::vector<float>{0, 0, 1, 1});  // two triangles
    }
    SUBCASE("indexed") {
      mesh.indices = {1, 0, 0, 1};
      mesh.add(0.0, {0.0f, 1.0f});
      mesh.add(1.0, {0.5f, 0.25f});
      CHECK(mesh.translated().values == std::vector<float>{1, 0, 0, 1, 0.25f, 0.5f, 0.5f, 0.25f});
    }
  }

  TEST_CASE("a curve is followed within a step of 8 bits by the fewest segments") {
    Painted mesh;
    const auto curve = [](double u) { return 0.5 + 0.5 * std::sin(3 * u); };
    for (const double u : uniform_times(128)) mesh.add(u, std::vector<float>(4, float(curve(u))));
    const Primvar<float> opacity = mesh.translated();
    CHECK(opacity.segments == 16);  // h^2 / 8 times 4.5 is 1 / 455 at 16 segments, 1 / 114 at 8
    for (const double u : uniform_times(1000)) {
      CHECK(std::abs(at(opacity, 2, u) - curve(u)) <= kPrimvarTolerance + 1e-4);
    }
  }

  TEST_CASE("values that do not change over many samples have one key") {
    Painted mesh;
    for (const double u : uniform_times(16)) mesh.add(u, {0.1f, 0.2f, 0.3f, 0.4f});
    CHECK(mesh.translated().segments == 0);
  }

  TEST_CASE("values that jump keep their mean") {
    Painted mesh;
    mesh.add(0.0, {0, 0, 1, 1});
    mesh.add(0.3 - 1e-6, {0, 0, 1, 1});
    mesh.add(0.3, {1, 0, 0, 1});
    const Primvar<float> opacity = mesh.translated();
    CHECK(mesh.diagnostics.empty());
    CHECK(opacity.segments >= 16);
    double mean[4] = {};
    for (int i = 0; i < 10000; ++i) {
      for (std::size_t k = 0; k < 4; ++k) mean[k] += at(opacity, k, (i + 0.5) / 10000) / 10000;
    }
    CHECK(mean[0] == doctest::Approx(0.7).epsilon(1e-4));
    CHECK(mean[1] == 0.0);
    CHECK(mean[2] == doctest::Approx(0.3).epsilon(1e-4));
    CHECK(mean[3] == doctest::Approx(1.0));
    CHECK(at(opacity, 0, 0.2) == 0.0);
    CHECK(at(opacity, 0, 0.4) == doctest::Approx(1.0));
  }

  TEST_CASE("too few segments are named") {
    Painted mesh;
    for (const double u : uniform_times(8)) mesh.add(u, std::vector<float>(4, float(int(8 * u) % 2)));
    CHECK(mesh.translated(4).segments == 4);
    REQUIRE(mesh.diagnostics.size() == 1);
    CHECK(mesh.diagnostics[0].path == "/mesh");
    CHECK(mesh.diagnostics[0].attribute == "primvars:displayOpacity");
    CHECK(mesh.diagnostics[0].message.find("the values deviate by 1 at 4 segments") == 0);
  }

  TEST_CASE("samples that do not fit together leave the frame's values, with a warning") {
    Painted mesh;
    mesh.add(0.0, {0.1f, 0.2f, 0.3f, 0.4f});
    std::string expected;
    SUBCASE("another number") {
      mesh.add(1.0, {0.5f, 0.5f});
      expected = "found 2 values at shutter time 1";
    }
    SUBCASE("not finite") {
      mesh.add(1.0, {0.5f, std::numeric_limits<float>::quiet_NaN(), 0.5f, 0.5f});
      expected = "found a value at shutter time 1";
    }
    SUBCASE("times that go back") {
      mesh.add(-1.0, {0.5f, 0.5f, 0.5f, 0.5f});
      expected = "found sample times that do not increase";
    }
    const Primvar<float> opacity = mesh.translated();
    CHECK(opacity.segments == 0);
    CHECK(opacity.values == std::vector<float>{0.1f, 0.2f, 0.3f, 0.4f});
    REQUIRE(mesh.diagnostics.size() == 1);
    CHECK(mesh.diagnostics[0].severity == Severity::kWarning);
    CHECK(mesh.diagnostics[0].message.find(expected) == 0);
  }
}
