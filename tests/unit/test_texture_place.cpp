// Where on a texture a hit is, how large a ray's footprint is there, and which way bumps point.
#include <cmath>
#include <doctest/doctest.h>

#include "core/shade/material/surface_values.h"
#include "core/shade/material/texture_place.h"

namespace msbvh {
namespace {

constexpr PrimvarName kSt = 0;

// A right triangle in the plane z = 0 with legs of 2 and 4, on which s runs from `s0` by `ds` along x and t
// by `dt` along y.
Scene triangle_with(float s0, float ds, float dt) {
  Scene scene;
  Mesh mesh;
  mesh.shape.vertex_count = 3;
  mesh.shape.positions = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}};
  mesh.shape.triangles = {{0, 1, 2}};
  mesh.primvars = {{kSt, {Interpolation::kVertex, 0, {{s0, 0, 0}, {s0 + 2 * ds, 0, 0}, {s0, 4 * dt, 0}}}}};
  scene.meshes = {mesh};
  scene.world = {mesh_id(0)};
  scene.primvar_names = {"st"};
  return scene;
}

const Ray kDown{.org = {0, 0, 1}, .dir = {0, 0, -1}};
const Hit kHit{.t = 1.0f, .u = 0.25f, .v = 0.5f, .triangle = 0};
const Vec3f kUp{0, 0, 1};

std::optional<TexturePlace> place_on(const Scene& scene, PrimvarName name = kSt) {
  return texture_place(SceneIndex(scene).resolve(kHit), kHit, kDown, name);
}

void check_near(const Vec3f& found, const Vec3f& expected) {
  CAPTURE(found.x);
  CAPTURE(found.y);
  CAPTURE(found.z);
  CHECK(length(found - expected) < 1e-5f);
}

TEST_CASE("coordinates at a hit, and how they change a unit of the world") {
  const TexturePlace place = *place_on(triangle_with(0.5f, 3.0f, -0.25f));
  CHECK(place.s == doctest::Approx(0.5f + 0.25f * 6.0f));
  CHECK(place.t == doctest::Approx(-0.5f));
  check_near(place.s_gradient, {3, 0, 0});
  check_near(place.t_gradient, {0, -0.25f, 0});
  CHECK(!place_on(triangle_with(0, 1, 1), 1).has_value());
  Scene unauthored = triangle_with(0, 1, 1);
  unauthored.meshes[0].primvars[0].primvar.values.clear();
  CHECK(!place_on(unauthored).has_value());
}

TEST_CASE("under an instance coordinates change with its size") {
  Scene scene = triangle_with(0, 1, 1);
  scene.world.clear();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, 0, {{{5, 0, 0}, {0, 5, 0}, {0, 0, 5}, {}}}, {}}};
  Hit hit = kHit;
  hit.instance = 0;
  const auto place = texture_place(SceneIndex(scene).resolve(hit), hit, kDown, kSt);
  check_near(place->s_gradient, {0.2f, 0, 0});
}

TEST_CASE("an instance's own value is the same all over it") {
  Scene scene = triangle_with(0, 1, 1);
  scene.world.clear();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, 0, std::vector<Affine3f>(2), {}}};
  scene.instances[0].primvars = {{kSt, {{0.1f, 0.2f, 0}, {0.3f, 0.4f, 0}}}};
  Hit hit = kHit;
  hit.instance = 1;
  const auto place = texture_place(SceneIndex(scene).resolve(hit), hit, kDown, kSt);
  CHECK(place->s == 0.3f);
  CHECK(place->t == 0.4f);
  CHECK(place->s_gradient == Vec3f{});
}

TEST_CASE("a footprint is as wide as the cone across the ray, longer along it, and goes through the matrix") {
  const auto place = place_on(triangle_with(0, 1, 1));
  TextureRead read;
  read.matrix = {2, 0, 0, 3};
  read.offset = {10, 20};
  const TextureQuery straight = texture_query(read, place, kUp, {0, 0, -1}, 0.1f);
  CHECK(straight.s == doctest::Approx(2.0f * place->s + 10.0f));
  CHECK(straight.t == doctest::Approx(3.0f * place->t + 20.0f));
  // A circle, whatever its axes are: the sum of squares by coordinate.
  CHECK(std::hypot(straight.ds_dx, straight.ds_dy) == doctest::Approx(0.2f));
  CHECK(std::hypot(straight.dt_dx, straight.dt_dy) == doctest::Approx(0.3f));
  const float sine = std::sqrt(0.75f);
  const TextureQuery slanted = texture_query({}, place, kUp, {sine, 0, -0.5f}, 0.1f);
  CHECK(std::hypot(slanted.ds_dx, slanted.ds_dy) == doctest::Approx(0.2f));  // 1 / cos 60 degrees
  CHECK(std::hypot(slanted.dt_dx, slanted.dt_dy) == doctest::Approx(0.1f));
  const TextureQuery grazing = texture_query({}, place, kUp, normalize(Vec3f{1, 0, -1e-4f}), 0.1f);
  CHECK(std::hypot(grazing.ds_dx, grazing.ds_dy) == doctest::Approx(1.6f));  // no longer than that
}

TEST_CASE("without coordinates the read's fallback goes through the matrix, as a point") {
  TextureRead read;
  read.fallback_coordinates = {0.25f, 0.75f};
  read.matrix = {0, -1, 1, 0};
  const TextureQuery query = texture_query(read, std::nullopt, kUp, {0, 0, -1}, 0.1f);
  CHECK(query.s == -0.75f);
  CHECK(query.t == 0.25f);
  CHECK(query.ds_dx == 0.0f);
  CHECK(query.dt_dy == 0.0f);
}

TEST_CASE("bumps follow the coordinates, mirrored ones too, and stay on the side that is seen") {
  const Vec3f right{0.6f, 0, 0.8f}, up{0, 0.6f, 0.8f};
  const TexturePlace plain = *place_on(triangle_with(0, 1, 1));
  check_near(bent_normal(right, kUp, plain), {0.6f, 0, 0.8f});
  check_near(bent_normal(up, kUp, plain), {0, 0.6f, 0.8f});
  check_near(bent_normal(right * 7.0f, kUp, plain), {0.6f, 0, 0.8f});
  const TexturePlace mirrored = *place_on(triangle_with(0, -1, 1));
  check_near(bent_normal(right, kUp, mirrored), {-0.6f, 0, 0.8f});
  check_near(bent_normal(up, kUp, mirrored), {0, 0.6f, 0.8f});
  check_near(bent_normal(right, -kUp, plain), {0.6f, 0, -0.8f});
}

TEST_CASE("a normal of no length, and coordinates that do not change, leave the surface's own") {
  const TexturePlace plain = *place_on(triangle_with(0, 1, 1));
  CHECK(bent_normal({}, kUp, plain) == kUp);
  CHECK(bent_normal({1, 0, 0}, kUp, *place_on(triangle_with(0, 0, 1))) == kUp);
  CHECK(bent_normal({1, 0, 0}, kUp, *place_on(triangle_with(0, 0, 0))) == kUp);
}

TEST_CASE("driven values take their channels, after scale and bias, and no light is negative") {
  const Scene scene = triangle_with(0, 1, 1);
  const HitSource source = SceneIndex(scene).resolve(kHit);
  Material material;
  material.texture_reads = {{.texture = 0, .scale = {2, 2, 2, 2}, .bias = {-1, -1, -1, -1}}};
  const auto texture = DrivenInput::Source::kTexture, primvar = DrivenInput::Source::kPrimvar;
  material.driven = {{SurfaceInput::kDiffuseColor, texture, 0, 1, false},
                     {SurfaceInput::kSpecularColor, texture, 0, 3, true},
                     {SurfaceInput::kEmissiveColor, texture, 0, 0, false},
                     {SurfaceInput::kRoughness, texture, 0, 2, false},
                     {SurfaceInput::kMetallic, primvar, kSt, 1, false},
                     {SurfaceInput::kClearcoat, primvar, 7, 0, false}};
  material.clearcoat = 0.125f;
  const TexelColor texel{0.25f, 0.5f, 0.75f, 1.0f};
  SurfaceValues values(material);
  drive(material, source, kHit, 0.0f, {&texel, 1}, values);
  CHECK(values.diffuse_color == Vec3f{0.0f, 0.5f, 1.0f});
  CHECK(values.specular_color == Vec3f{1.0f, 1.0f, 1.0f});
  CHECK(values.emissive_color == Vec3f{0.0f, 0.0f, 0.5f});
  CHECK(values.roughness == 0.5f);
  CHECK(values.metallic == 2.0f);     // t there
  CHECK(values.clearcoat == 0.125f);  // no such primvar: the constant
  material.specular = true;
  const SurfaceLook look = look_of(material, values);  // metallic counts as 1
  CHECK(look.diffuse == Vec3f{});
  CHECK(look.f0 == Vec3f{0.0f, 0.5f, 1.0f});
  CHECK(look.alpha == 0.25f);
}

}  // namespace
}  // namespace msbvh
