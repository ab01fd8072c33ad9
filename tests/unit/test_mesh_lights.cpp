// Meshes that shine, by Lambert's formula for polygons, and portals of domes.
#include <array>
#include <numeric>
#include <random>

#include "core/base/error.h"
#include "core/motion/affine_track.h"
#include "core/shade/light/light_sampler.h"
#include "core/shade/light/mesh_light.h"
#include "core/shade/light/portal.h"
#include "core/shade/warp.h"
#include "tests/unit/light_probe.h"

namespace msbvh {
namespace {

using namespace light_probe;

// Four corners in a plane, counter-clockwise, at two keys: it slides, turns and grows.
Mesh sheet() {
  Mesh mesh;
  mesh.shape.name = "/sheet";
  mesh.shape.segments = 1;
  mesh.shape.vertex_count = 4;
  mesh.shape.positions = {{-1, -1, 2},       {1, -1, 2}, {1, 1, 2},    {-1, 1, 2},
                          {-0.5f, -2, 1.5f}, {2, -2, 2}, {2, 1, 2.5f}, {-0.5f, 1, 2}};
  mesh.shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.shape = validated(std::move(mesh.shape));
  return mesh;
}

Light shining(const LightSurface& surface) {
  Light light;
  light.name = "/lamp";
  light.kind = LightKind::kMesh;
  light.radiance = {3.0f, 1.0f, 0.5f};
  light.surface = surface;
  return light;
}

// In the world, and through an instance that slides.
Scene two_sheets() {
  Scene scene;
  scene.meshes = {sheet(), sheet()};
  scene.world = {mesh_id(0)};
  scene.prototypes = {{"/prototype", {mesh_id(1)}}};
  const Affine3f wide{{1.5f, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, 0.5f}};
  scene.instances = {{"/instances", 0, 1, {Affine3f{}, Affine3f{}, wide, at({1, 0, 1})}, {}}};
  scene.lights = {shining({0}), shining({1, 0, 1})};
  return scene;
}

// J. H. Lambert, "Photometria", 1760: of a polygon above the horizon of a point at the origin that faces +z.
double polygon_irradiance(double radiance, const std::vector<Vec3d>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(corners[i]), b = normalize(corners[(i + 1) % corners.size()]);
    const Vec3d across = cross(a, b);
    sum += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * across.z / length(across);
  }
  return 0.5 * radiance * std::abs(sum);
}

// A bent sheet is two triangles.
double sheet_irradiance(const Scene& scene, const LightSurface& surface, float time) {
  const TriangleMesh& shape = scene.meshes[surface.mesh].shape;
  double sum = 0.0;
  for (const Triangle& t : shape.triangles) {
    std::vector<Vec3d> corners;
    for (const std::uint32_t v : t) {
      Vec3f p = shape.position(v, time);
      if (surface.set != LightSurface::kNoSet) {
        const InstanceSet& set = scene.instances[surface.set];
        p = evaluate(std::span(set.world_from_prototype).subspan(2 * surface.instance, 2), 1, time).point(p);
      }
      corners.push_back(Vec3d(p));
    }
    sum += polygon_irradiance(3.0, corners);
  }
  return sum;
}

SurfaceHit origin_facing_up() {
  SurfaceHit surface{};
  surface.geometric_normal = surface.shading_normal = {0, 0, 1};
  return surface;
}

TEST_CASE("mesh light: Lambert's irradiance at each time, in the world and through an instance") {
  const Scene scene = two_sheets();
  const LightSampler lights(scene, {});
  for (std::uint32_t which = 0; which < 2; ++which) {
    const LightPick& pick = lights.pick(which);
    REQUIRE(pick.mesh);
    for (const float time : {0.0f, 0.3f, 1.0f}) {
      double sum = 0.0, squares = 0.0;
      for (std::uint32_t i = 0; i < kSamples; ++i) {
        LightSample sample;
        double value = 0.0;
        if (pick.mesh->sample(origin_facing_up(), *pick.light, time, random_pair(i), sample))
          value = double(sample.irradiance.x) * std::max(0.0f, sample.direction.z);
        sum += value;
        squares += value * value;
      }
      const double mean = sum / kSamples, sigma = std::sqrt((squares / kSamples - mean * mean) / kSamples);
      const double expected = sheet_irradiance(scene, pick.light->surface, time);
      CAPTURE(which);
      CAPTURE(time);
      CAPTURE(mean);
      CAPTURE(expected);
      CHECK(std::abs(mean - expected) <= 4.5 * sigma + 1e-4 * expected);
    }
  }
}

TEST_CASE("mesh light: sampling a point and hitting it give the same density") {
  const Scene scene = two_sheets();
  const LightSampler lights(scene, {});
  for (std::uint32_t which = 0; which < 2; ++which) {
    const MeshLight& mesh = *lights.pick(which).mesh;
    for (std::uint32_t i = 0; i < 200; ++i) {
      LightSample sample;
      REQUIRE(mesh.sample(origin_facing_up(), scene.lights[which], 0.4f, random_pair(i), sample));
      CHECK(sample.irradiance.x == doctest::Approx(3.0 / sample.pdf));
      Hit hit;
      hit.t = sample.distance;
      double nearest = 1e30;
      for (hit.triangle = 0; hit.triangle < 2; ++hit.triangle)
        nearest =
            std::min(nearest, std::abs(double(mesh.pdf(sample.direction, hit, 0.4f)) / sample.pdf - 1.0));
      CHECK(nearest < 1e-4);
    }
  }
}

TEST_CASE("mesh light: triangles are picked by their area, and none without one") {
  TriangleMesh mesh;
  mesh.vertex_count = 5;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 0, 0}, {2, 0, 0}, {}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 4}, {0, 3, 2}};
  const TriangleShares shares(mesh);
  CHECK(shares.share(0) == doctest::Approx(0.25));
  CHECK(shares.share(1) == 0.0f);
  CHECK(shares.share(2) == doctest::Approx(0.75));
  std::array<int, 3> counts{};
  for (int i = 0; i < 1000; ++i) {
    const TriangleShares::Pick pick = shares.pick((float(i) + 0.5f) / 1000.0f);
    CHECK((pick.within >= 0.0f && pick.within < 1.0f));
    ++counts[pick.triangle];
  }
  CHECK(counts == std::array{250, 0, 750});
}

TEST_CASE("mesh light: hits name their light, and what is hidden at a time gives none then") {
  Scene scene = two_sheets();
  const SceneIndex index(scene);
  scene.prototypes[0].time_remap.pieces = {{0.0f, 0.0f, 0.5f, true}, {0.5f, 0.5f, 1.0f, false}};
  const LightSampler lights(scene, {});
  Hit hit;
  hit.triangle = 0;
  hit.geometry = mesh_id(0);
  CHECK(lights.mesh_at(index.resolve(hit)) == &lights.pick(0));
  hit.instance = 0;
  CHECK(lights.mesh_at(index.resolve(hit)) == nullptr);
  hit.instance = 1;
  REQUIRE(lights.mesh_at(index.resolve(hit)) == &lights.pick(1));
  LightSample sample;
  const MeshLight& mesh = *lights.pick(1).mesh;
  CHECK(mesh.sample(origin_facing_up(), scene.lights[1], 0.25f, {0.5f, 0.5f}, sample));
  CHECK(!mesh.sample(origin_facing_up(), scene.lights[1], 0.75f, {0.5f, 0.5f}, sample));
}

TEST_CASE("mesh light: of two on one mesh rays meet the first, and the other is sampled alone") {
  Scene scene = two_sheets();
  scene.lights.push_back(scene.lights[0]);
  scene.lights.push_back(scene.lights[0]);
  const LightSampler lights(scene, {});
  Hit hit;
  hit.geometry = mesh_id(0);
  REQUIRE(lights.mesh_at(SceneIndex(scene).resolve(hit)) == &lights.pick(0));
  LightSample sample;
  for (std::uint32_t which = 0; which < 4; ++which) {
    const MeshLight& mesh = *lights.pick(which).mesh;
    CHECK(mesh.is_met() == (which < 2));
    REQUIRE(mesh.sample(origin_facing_up(), scene.lights[which], 0.25f, {0.5f, 0.5f}, sample));
    CHECK((sample.pdf > 0.0f) == (which < 2));
  }
}

TEST_CASE("mesh light: a mesh without triangles is refused") {
  Scene scene = two_sheets();
  scene.meshes[0].shape.triangles.clear();
  CHECK_THROWS_WITH_AS(validate(scene), doctest::Contains("found a mesh without triangles"), Error);
}

Light guided_dome() {
  Light dome = light_of(LightKind::kDome, Affine3f{});
  dome.image = picture(ImageMap::kLatlong, 9, 8, lumpy);
  dome.portals = {{1.0f, 1.5f, 0, {at({0.3f, 0.2f, 1.0f})}},
                  {2.0f, 0.5f, 0, {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {2, 0, 1}}}},
                  {3.0f, 3.0f, 0, {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 4}}}}};  // faces away
  return dome;
}

TEST_CASE("portals: they change nothing of a dome but where it is sampled") {
  const Light guided = guided_dome();
  Light plain = guided;
  plain.portals.clear();
  check_irradiance(guided, gathered(plain));
  const PlacedLight dome(guided, 0.0f);
  double through = 0.0, density = 0.0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    LightSample sample;
    if (!sample_light(guided, {}, {}, 0.0f, random_pair(i), sample)) continue;
    LightAlong along;
    REQUIRE(find_light(guided, {}, sample.direction, 0.0f, along));
    CHECK(along.pdf == doctest::Approx(sample.pdf));
    through += portal_pdf(dome, {}, sample.direction) > 0.0f;
  }
  CHECK(through / kSamples > kPortalShare);
  constexpr int kRows = 800, kColumns = 1600;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kColumns; ++j)
      density += portal_pdf(dome, {}, on_sphere(2 * (i + 0.5) / kRows - 1, 2 * kPiD * (j + 0.5) / kColumns));
  }
  CHECK(density * 4 * kPiD / (double(kRows) * kColumns) == doctest::Approx(1.0).epsilon(5e-3));
}

TEST_CASE("portals: none guides from where the dome is") {
  const Light guided = guided_dome();
  const PlacedLight dome(guided, 0.0f);
  CHECK(any_portal(dome, {}));
  CHECK(!any_portal(dome, {5, 0, 2}));
}

}  // namespace
}  // namespace msbvh
