// Instances: keys for each, groups by their number, singular and broken matrices, prototypes far from their
// origin.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

#include "core/motion/affine_track.h"
#include "core/scene/scene.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

const Affine3d kCollapsed{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
const Affine3d kFlat{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 0}};

// Instances that move on their own, sampled at shared times, of a unit quad; seen from 10 units away.
struct Instanced {
  explicit Instanced(std::vector<double> times, Vec3d eye = {0, 0, 10},
                     const TranslatorSettings& settings = settings_of())
      : translator(camera_at(eye), settings), times01(std::move(times)) {
    prototype = translator.begin_prototype("/prototype");
    translator.add_prototype_mesh(prototype, MeshFixture().input());
  }
  // `last_colors`: at the shutter's closing; `colors` are those at its opening then.
  void add(const std::vector<Motion>& motions, std::span<const Vec3f> colors = {},
           std::span<const Vec3f> last_colors = {}) {
    for (const double time01 : times01) {
      for (const Motion& motion : motions) matrices.push_back(row_vector_matrix(motion(time01)));
    }
    InstancesInput input = instances_of("/instances", prototype, times01, matrices, colors);
    if (!last_colors.empty()) input.display_color.samples = {{0.0, colors}, {1.0, last_colors}};
    translator.add_instances(input);
  }

  Translator translator;
  std::vector<double> times01;
  std::vector<Matrix4d> matrices;
  std::uint32_t prototype;
};

Motion spin(double degrees) {
  return [degrees](double u) { return rotation(degrees * u); };
}

}  // namespace

TEST_SUITE("translate: instances") {
  TEST_CASE("each instance takes the fewest keys; those of equal number form a set in the input's order") {
    Instanced instanced(uniform_times(128), {0, 0, 10}, linear_settings());
    const auto slide = [](double u) { return translation({3 * u, 0, 0}); };
    const auto at = [](double x) { return [x](double) { return translation({x, 0, 0}); }; };
    const std::vector<Vec3f> colors{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
    instanced.add({at(1), slide, spin(90), at(2), spin(10)}, colors);
    CHECK(instanced.translator.diagnostics().empty());
    const TrackReport track = instanced.translator.tracks().back();
    const auto scene = instanced.translator.finish();
    validate(*scene);

    REQUIRE(scene->instances.size() == 4);
    CHECK(scene->instances[0].segments == 0);
    REQUIRE(scene->instances[0].world_from_prototype.size() == 2);
    CHECK(scene->instances[0].world_from_prototype[1].t == Vec3f{2, 0, -10});
    CHECK(scene->instances[0].display_color == std::vector<Vec3f>{{1, 0, 0}, {4, 0, 0}});
    CHECK(scene->instances[1].segments == 1);
    CHECK(scene->instances[1].world_from_prototype[1].t == Vec3f{3, 0, -10});
    CHECK(scene->instances[2].segments == 4);
    CHECK(scene->instances[3].segments == 32);
    CHECK(scene->instances[3].display_color == std::vector<Vec3f>{{3, 0, 0}});
    CHECK(track.segments == 32);
    CHECK(track.moving_transform);
    CHECK(track.error_pixels <= 0.1);
  }

  TEST_CASE("colours that change keep to their instances, whichever set takes them") {
    Instanced instanced(uniform_times(128), {0, 0, 10}, linear_settings());
    const auto slide = [](double u) { return translation({3 * u, 0, 0}); };
    const auto at = [](double x) { return [x](double) { return translation({x, 0, 0}); }; };
    const std::vector<Vec3f> begin{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, end{{0, 1, 0}, {1, 1, 1}, {1, 0, 0}};
    instanced.add({at(1), slide, at(2)}, begin, end);
    CHECK(instanced.translator.diagnostics().empty());
    const auto scene = instanced.translator.finish();
    validate(*scene);
    REQUIRE(scene->instances.size() == 2);
    CHECK(scene->instances[0].color_segments == 1);
    CHECK(scene->instances[0].display_color ==
          std::vector<Vec3f>{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}});
    CHECK(scene->instances[1].display_color == std::vector<Vec3f>{{0, 1, 0}, {1, 1, 1}});
  }

  TEST_CASE("prims that are instances have track reports and materials of their own") {
    Instanced instanced(uniform_times(128), {0, 0, 10}, linear_settings());
    instanced.translator.add_material({});
    const std::vector<Motion> motions{[](double) {
                                        return translation({1, 0, 0});
                                      },
                                      [](double u) {
                                        return translation({3 * u, 0, 0});
                                      }};
    for (const double time01 : instanced.times01) {
      for (const Motion& motion : motions) instanced.matrices.push_back(row_vector_matrix(motion(time01)));
    }
    InstancesInput input =
        instances_of("/still", instanced.prototype, instanced.times01, instanced.matrices, {});
    input.paths = {"/still", "/moves"};
    const std::vector<int> materials{-1, 0};
    input.materials = materials;
    instanced.translator.add_instances(input);
    const std::vector<TrackReport> tracks = instanced.translator.tracks();
    const auto scene = instanced.translator.finish();
    validate(*scene);
    REQUIRE(tracks.size() == 4);  // with the camera's and the prototype's
    CHECK(tracks[2].path == "/still");
    CHECK(tracks[2].segments == 0);
    CHECK(tracks[2].rule == "still");
    CHECK(tracks[3].path == "/moves");
    CHECK(tracks[3].segments == 1);
    CHECK(tracks[3].source == "transform");
    CHECK(tracks[3].bytes == 2 * tracks[2].bytes);
    REQUIRE(scene->instances.size() == 2);
    CHECK(scene->instances[0].materials == std::vector{kNone});
    CHECK(scene->instances[1].materials == std::vector{0u});
    input.paths.push_back("/third");
    instanced.translator.add_instances(input);
    CHECK(instanced.translator.diagnostics().size() == 1);
  }

  TEST_CASE("the track stays within the tolerance in pixels at dense times") {
    const Vec3d eye{0, 0, 10};
    Instanced instanced(uniform_times(128), eye);
    instanced.add({spin(77)});
    const auto scene = instanced.translator.finish();
    const InstanceSet& set = scene->instances.at(0);
    double worst = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const float u = float(i / 1000.0);
      for (const Vec3d corner : {Vec3d{1, 0, 0}, Vec3d{1, 1, 0}}) {
        const Vec3d found = Affine3d(evaluate(set.world_from_prototype, set.form(), u)).point(corner);
        const Vec3d truth = rotation(77.0 * u).point(corner) - eye;
        worst = std::max(worst, 500 * length(found * (-1 / found.z) - truth * (-1 / truth.z)));
      }
    }
    CHECK(worst <= 0.1);
    CHECK(set.form().controls() <= 7);  // neither is it followed with far more than it takes
  }

  TEST_CASE(
      "matrices that vanish at one time are kept; those that always do are not, and planes are told of") {
    Instanced instanced({0.0, 1.0});
    const auto grow = [](double u) { return u == 0.0 ? kCollapsed : translation({0, 0, 0}); };
    instanced.add({grow, [](double) { return kCollapsed; }, [](double) { return kFlat; }});
    REQUIRE(instanced.translator.diagnostics().size() == 1);
    const Diagnostic& diagnostic = instanced.translator.diagnostics()[0];
    CHECK(diagnostic.severity == Severity::kWarning);
    CHECK(diagnostic.message.find("1 of 3 instances placed together (number 2 is the first)") !=
          std::string::npos);
    const auto scene = instanced.translator.finish();
    REQUIRE(scene->instances.size() == 1);
    CHECK(instance_count(scene->instances[0]) == 1);
    CHECK(scene->instances[0].segments == 1);
  }

  TEST_CASE("instances whose matrix is not finite are left out and counted") {
    Instanced instanced({0.0, 1.0});
    const auto broken = [](double u) {
      return translation({0, std::numeric_limits<double>::quiet_NaN() * u, 0});
    };
    instanced.add({broken, spin(0), broken});
    REQUIRE(instanced.translator.diagnostics().size() == 1);
    CHECK(instanced.translator.diagnostics()[0].message.find(
              "2 of 3 instances placed together (number 0 is the first)") != std::string::npos);
    CHECK(instance_count(instanced.translator.finish()->instances.at(0)) == 1);
  }

  TEST_CASE("colours that do not fit are left out; an unknown prototype is an error") {
    Instanced instanced({0.0});
    const std::vector<Vec3f> colors(3);
    instanced.add({spin(0), spin(0)}, colors);
    CHECK(count(instanced.translator, Severity::kWarning, "primvars:displayColor") == 1);
    instanced.translator.add_instances(instances_of("/instances", 9, instanced.times01, instanced.matrices));
    CHECK(count(instanced.translator, Severity::kError, "prototypes") == 1);
    const auto scene = instanced.translator.finish();
    REQUIRE(scene->instances.size() == 1);
    CHECK(scene->instances[0].display_color.empty());
  }

  TEST_CASE("a prototype far from its own origin, brought back by its instances, keeps its precision") {
    const Vec3f far{3e7f, -3e7f, 3e7f};  // floats there are 2 apart
    MeshFixture fixture;
    for (Vec3f& p : fixture.points[0]) p = p * 4.0f + far;
    Translator translator(camera_at({}), settings_of());
    const std::uint32_t prototype = translator.begin_prototype("/prototype");
    translator.add_prototype_mesh(prototype, fixture.input());
    const std::vector<Matrix4d> back{row_vector_matrix(translation(Vec3d{0, 0, -5} - Vec3d(far)))};
    translator.add_instances(instances_of("/instances", prototype, {0.0}, back));
    const auto scene = translator.finish();
    const Affine3f map = scene->instances.at(0).world_from_prototype.at(0);
    const TriangleMesh& shape = scene->meshes.at(0).shape;
    CHECK(map.point(shape.position(0, 0)) == Vec3f{0, 0, -5});
    CHECK(map.point(shape.position(2, 0)) == Vec3f{4, 4, -5});
  }

  TEST_CASE("sub-millimetre motion of an instance 1e7 from the stage's origin") {
    const Vec3d far{1e7, 1e7, -1e7};
    Instanced instanced({0.0, 1.0}, far + Vec3d{0, 0, 1});
    instanced.add({[&](double u) { return translation(far + Vec3d{3e-4 * u, 0, 0}); }});
    const auto scene = instanced.translator.finish();
    const InstanceSet& set = scene->instances.at(0);
    CHECK(set.segments == 1);
    CHECK(set.world_from_prototype[0].t.z == doctest::Approx(-1.0));
    CHECK(set.world_from_prototype[1].t.x - set.world_from_prototype[0].t.x ==
          doctest::Approx(3e-4).epsilon(1e-4));
  }

  TEST_CASE("deforming meshes of a prototype are measured as if it filled the image") {
    MeshFixture fixture;
    const auto sheared = [](double x) {
      return std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1 + float(x), 1, 0}, {0, 1, 0}};
    };
    fixture.add_points(0.5, sheared(0.5));
    fixture.add_points(1.0, sheared(0.0));
    Translator translator(camera_at({}), settings_of());
    translator.add_prototype_mesh(translator.begin_prototype("/prototype"), fixture.input());
    CHECK(translator.tracks().back().segments == 2);
    CHECK(translator.empty());  // nothing instances it
  }
}
