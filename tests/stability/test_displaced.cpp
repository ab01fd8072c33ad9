// Displaced surfaces from the translator's input to rays: what is closed stays closed, moving too, and where
// texture coordinates have seams.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <memory>
#include <vector>

#include "core/trace/tracer.h"
#include "tests/property/support.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::procedural;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

// A rough texture of 16 x 16 texels between 0 and 1.
std::shared_ptr<const ScalarTexture> rough() {
  ScalarImage image{16, 16};
  for (int i = 0; i < 256; ++i)
    image.values.push_back(float(std::fmod(std::abs(std::sin(i * 12.9898)) * 43758.5453, 1.0)));
  return std::make_shared<const ScalarTexture>(image, Wrap::kRepeat, Wrap::kRepeat);
}

Displacement by_texture() {
  Displacement displacement{.texture = rough()};
  displacement.coordinates.primvar = "st";
  displacement.scale = 0.3;
  displacement.bias = -0.1;
  return displacement;
}

// A cube whose every face has the whole texture, which turns and moves between three samples.
struct Cage {
  MeshFixture mesh;
  std::vector<Vec3f> st;
  Vec3d from, to;

  explicit Cage(const Vec3d& position) : from(position), to(position + Vec3d{3, -1, 2}) {
    mesh.counts = std::vector<int>(6, 4);
    mesh.indices = {0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3};
    mesh.times01.clear();
    mesh.points.clear();
    for (const double time01 : {0.0, 0.5, 1.0}) {
      std::vector<Vec3f> points;
      for (int i = 0; i < 8; ++i) {
        const Vec3d corner{i & 4 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 1 ? 1.0 : -1.0};
        points.push_back(Vec3f(rotation(70.0 * time01).point(corner) + centre(time01)));
      }
      mesh.add_points(time01, std::move(points));
    }
    for (int face = 0; face < 6; ++face) st.insert(st.end(), {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  }

  Vec3d centre(double time01) const { return from + (to - from) * time01; }
  MeshInput input(const std::string& scheme) const {
    MeshInput input = mesh.input();
    input.subdivision.scheme = scheme;
    input.named_primvars.push_back({"st", {"faceVarying", st, {}}});
    input.material = 0;
    return input;
  }
};

std::shared_ptr<const Scene> translated(const Cage& cage, const std::string& scheme, std::uint32_t max_degree,
                                        Displaced kept) {
  TranslatorSettings settings = settings_of(300);
  settings.choice.max_degree = max_degree;
  settings.edge_length_pixels = 4.0;
  settings.displaced = kept;
  Translator translator(camera_at(cage.from + Vec3d{1, 0, 8}), settings);
  translator.add_material(Material{}, by_texture());
  translator.add_mesh(cage.input(scheme));
  for (const Diagnostic& d : translator.diagnostics()) CAPTURE(d.message);
  CHECK(translator.diagnostics().empty());
  // What the scene has is relative to the frame's origin.
  REQUIRE(translator.origin() == cage.from + Vec3d{1, 0, 8});
  return translator.finish();
}

Accel accel_of(const Scene& scene, Displaced kept) {
  const bool patches = kept == Displaced::kAsPatches;
  REQUIRE(scene.meshes.size() == (patches ? 0u : 1u));
  REQUIRE(scene.grids.size() == (patches ? 1u : 0u));
  CHECK((patches ? scene.grids[0].shape.segments : scene.meshes[0].shape.segments) > 1);
  Accel accel;
  patches ? accel.add_grids(scene.grids[0].shape) : accel.add_mesh(scene.meshes[0].shape);
  accel.commit();
  accel.verify();
  return accel;
}

void check_no_leak(const std::string& scheme, std::uint32_t max_degree, Displaced kept, double position,
                   std::uint64_t rays) {
  const Cage cage({position, position, -position});
  const Accel accel = accel_of(*translated(cage, scheme, max_degree, kept), kept);
  const Vec3d origin = cage.from + Vec3d{1, 0, 8};
  Random random(7);
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(instruction_set_name(set));
    const Tracer tracer(accel.bvh(), set);
    std::uint64_t misses = 0;
    for (std::uint64_t i = 0; i < rays; ++i) {
      Ray ray;
      ray.time = random.uniform();
      ray.org = Vec3f(cage.centre(double(ray.time)) - origin);
      ray.dir = random.direction();
      Hit hit;
      misses += !tracer.intersect(ray, hit);
    }
    CHECK(misses == 0);
  }
}

}  // namespace

TEST_CASE("closed displaced moving surfaces do not leak, whatever their texture's seams") {
  for (const char* scheme : {"catmullClark", "bilinear"}) {
    for (const std::uint32_t degree : {1u, 3u}) {
      for (const Displaced kept : {Displaced::kAsTriangles, Displaced::kAsPatches}) {
        for (const double position : {0.0, 1e4}) {
          CAPTURE(scheme);
          CAPTURE(degree);
          CAPTURE(int(kept));
          CAPTURE(position);
          check_no_leak(scheme, degree, kept, position, 20'000);
        }
      }
    }
  }
}

TEST_SUITE("slow") {
  TEST_CASE("ten million rays inside a closed displaced moving surface: no leak") {
    for (const Displaced kept : {Displaced::kAsTriangles, Displaced::kAsPatches})
      check_no_leak("catmullClark", 3, kept, 1e4, 10'000'000);
  }
}
