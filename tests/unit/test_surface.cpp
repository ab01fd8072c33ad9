#include <cmath>
#include <doctest/doctest.h>
#include <random>

#include "core/motion/affine_track.h"
#include "core/shade/surface_hit.h"

namespace msbvh {
namespace {

// A triangle at z = 0, with a corner at the origin and legs of length 1.
Scene triangle_scene() {
  Scene scene;
  Mesh mesh;
  mesh.shape.vertex_count = 3;
  mesh.shape.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.shape.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  scene.world = {mesh_id(0)};
  return scene;
}

// Instances of that mesh alone.
Scene instanced_scene(std::uint32_t segments, std::vector<Affine3f> world_from_prototype) {
  Scene scene = triangle_scene();
  scene.world.clear();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, segments, std::move(world_from_prototype), {}}};
  return scene;
}

SurfaceHit surface(const Scene& scene, const Hit& hit, const Ray& ray) {
  return surface_at(scene, SceneIndex(scene).resolve(hit), hit, ray);
}

const Ray kDown{.org = {0, 0, 1}, .dir = {0, 0, -1}};
const Ray kUp{.org = {0, 0, -1}, .dir = {0, 0, 1}};
const Hit kHit{.u = 0.25f, .v = 0.5f, .triangle = 0};

TEST_CASE("position and geometric normal, on the ray's side") {
  const Scene scene = triangle_scene();
  const SurfaceHit from_above = surface(scene, kHit, kDown);
  CHECK(from_above.position == Vec3f{0.25f, 0.5f, 0});
  CHECK(from_above.geometric_normal == Vec3f{0, 0, 1});
  CHECK(from_above.shading_normal == Vec3f{0, 0, 1});
  CHECK(surface(scene, kHit, kUp).geometric_normal == Vec3f{0, 0, -1});
}

TEST_CASE("a moving vertex is where its track says") {
  Scene scene = triangle_scene();
  TriangleMesh& shape = scene.meshes[0].shape;
  shape.segments = 2;
  for (const float z : {0.0f, 4.0f}) {
    shape.positions.insert(shape.positions.end(), {{0, 0, z}, {1, 0, z}, {0, 1, z}});
  }
  Ray ray = kDown;
  ray.time = 0.75f;
  CHECK(surface(scene, kHit, ray).position == Vec3f{0.25f, 0.5f, 2.0f});
}

TEST_CASE("through an instance at the ray's time: position, normals and colour") {
  Affine3f moved;
  moved.t = {0, 0, 8};
  Affine3f squashed{{2, 0, 0}, {0, 1, 0}, {0, 0, -1}, {5, 0, 0}};  // mirrored and not uniform
  Scene scene = instanced_scene(1, {Affine3f{}, moved, squashed, squashed});
  scene.instances[0].display_color = {{1, 0, 0}, {0, 1, 0}};
  scene.meshes[0].normals.values = {{1, 0, 1}};
  Ray ray = kDown;
  ray.time = 0.5f;
  Hit hit = kHit;
  hit.instance = 0;
  const SurfaceHit first = surface(scene, hit, ray);
  CHECK(first.position == Vec3f{0.25f, 0.5f, 4.0f});
  CHECK(first.albedo == Vec3f{1, 0, 0});

  hit.instance = 1;
  const SurfaceHit second = surface(scene, hit, ray);
  CHECK(second.position == Vec3f{5.5f, 0.5f, 0.0f});
  CHECK(second.albedo == Vec3f{0, 1, 0});
  CHECK(second.geometric_normal == Vec3f{0, 0, 1});
  // The inverse transpose of diag(2, 1, -1) makes (1, 0, 1) into (0.5, 0, -1), which faces away.
  const Vec3f expected = normalize(Vec3f{-0.5f, 0, 1});
  CHECK(length(second.shading_normal - expected) < 1e-6f);
}

TEST_CASE("colours of instances move by key, in the shutter's time") {
  Scene scene = instanced_scene(0, {Affine3f{}, Affine3f{}});
  scene.instances[0].color_segments = 2;
  scene.instances[0].display_color = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}};
  Ray ray = kDown;
  Hit hit = kHit;
  hit.instance = 1;
  ray.time = 0.25f;
  CHECK(surface(scene, hit, ray).albedo == Vec3f{0.5f, 1, 0.5f});
  hit.instance = 0;
  ray.time = 0.75f;
  CHECK(surface(scene, hit, ray).albedo == Vec3f{0, 0, 0.5f});
}

TEST_CASE("primvars of every interpolation") {
  Scene scene = triangle_scene();
  Primvar<Vec3f>& color = scene.meshes[0].display_color;
  const std::vector<Vec3f> corners{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK(surface(scene, kHit, kDown).albedo == Vec3f{0.18f, 0.18f, 0.18f});
  color.values = {{0.1f, 0.2f, 0.3f}};
  for (const Interpolation one : {Interpolation::kConstant, Interpolation::kTriangle}) {
    color.interpolation = one;
    CHECK(surface(scene, kHit, kDown).albedo == color.values[0]);
  }
  color.values = corners;
  for (const Interpolation blended : {Interpolation::kVertex, Interpolation::kFaceVarying}) {
    color.interpolation = blended;
    CHECK(surface(scene, kHit, kDown).albedo == Vec3f{0.25f, 0.25f, 0.5f});
  }
  color.segments = 1;
  color.values.insert(color.values.end(), 3, Vec3f{1, 1, 1});
  Ray ray = kDown;
  ray.time = 0.5f;
  CHECK(surface(scene, kHit, ray).albedo == Vec3f{0.625f, 0.625f, 0.75f});
}

TEST_CASE("materials: their constants, and displayColor only where they read it") {
  Scene scene = triangle_scene();
  scene.meshes[0].material = 0;
  scene.meshes[0].display_color.values = {{1, 0, 0}};
  scene.materials.resize(1);
  scene.materials[0].diffuse_color = {0, 1, 0};
  scene.materials[0].emissive_color = {0, 0, 7};
  CHECK(surface(scene, kHit, kDown).albedo == Vec3f{0, 1, 0});
  CHECK(surface(scene, kHit, kDown).emission == Vec3f{0, 0, 7});
  scene.materials[0].diffuse_from_display_color = true;
  CHECK(surface(scene, kHit, kDown).albedo == Vec3f{1, 0, 0});
  CHECK(surface(scene, kHit, kDown).emission == Vec3f{0, 0, 7});
  scene.materials[0].emissive_from_display_color = true;
  CHECK(surface(scene, kHit, kDown).emission == Vec3f{1, 0, 0});
  scene.meshes[0].display_color.values.clear();
  CHECK(surface(scene, kHit, kDown).emission == Vec3f{0, 0, 7});
}

TEST_CASE("triangles and instances may have materials of their own") {
  Scene scene = triangle_scene();
  scene.meshes[0].shape.triangles.push_back({0, 1, 2});
  scene.meshes[0].material = 0;
  scene.materials.resize(2);
  scene.materials[0].diffuse_color = {0, 1, 0};
  scene.materials[1].diffuse_color = {0, 0, 1};
  scene.materials[1].opacity = 0.25f;
  const Hit second{.u = 0.25f, .v = 0.5f, .triangle = 1};
  const auto opacity = [&](const Hit& hit) {
    return opacity_at(scene, SceneIndex(scene).resolve(hit), hit, 0.0f);
  };
  SUBCASE("of triangles") {
    scene.meshes[0].triangle_materials = {1, kNone};
    CHECK(surface(scene, kHit, kDown).albedo == Vec3f{0, 0, 1});
    CHECK(surface(scene, second, kDown).albedo == Vec3f{0.18f, 0.18f, 0.18f});
    CHECK(opacity(kHit) == 0.25f);
    CHECK(opacity(second) == 1.0f);
  }
  SUBCASE("of instances, before those of triangles") {
    scene.meshes[0].triangle_materials = {0, 1};
    scene.world.clear();
    scene.prototypes = {{"/prototype", {mesh_id(0)}}};
    scene.instances = {{"/instances", 0, 0, std::vector<Affine3f>(3), {}}};
    scene.instances[0].materials = {0, 1, kNone};
    const Vec3f albedos[] = {{0, 1, 0}, {0, 0, 1}, {0.18f, 0.18f, 0.18f}};
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Hit hit{.u = 0.25f, .v = 0.5f, .triangle = i % 2, .instance = i};
      CHECK(surface(scene, hit, kDown).albedo == albedos[i]);
      CHECK(opacity(hit) == (i == 1 ? 0.25f : 1.0f));
    }
  }
}

TEST_CASE("opacity is read at the point") {
  Scene scene = triangle_scene();
  scene.meshes[0].display_opacity.interpolation = Interpolation::kVertex;
  scene.meshes[0].display_opacity.values = {0, 1, 0.5f};
  CHECK(opacity_at(scene, SceneIndex(scene).resolve(kHit), kHit, 0.0f) == 0.5f);
}

TEST_CASE("ids of instances run through the sets, those of meshes through the prototype") {
  Scene scene = instanced_scene(0, std::vector<Affine3f>(3));
  scene.meshes.push_back(scene.meshes[0]);
  scene.prototypes.push_back({"/other", {mesh_id(1), mesh_id(0)}});
  scene.instances.push_back({"/none", 0, 0, {}, {}});
  scene.instances.push_back({"/others", 1, 0, std::vector<Affine3f>(2), {}});
  const HitSource source = SceneIndex(scene).resolve({.geometry = mesh_id(0), .instance = 4});
  CHECK(source.mesh == &scene.meshes[1]);
  CHECK(source.instances == &scene.instances[2]);
  CHECK(source.instance == 1);
}

// Moving triangles 1e4 from the origin, some behind an instance's transform: the origin of a ray that leaves
// the surface must lie beyond its plane, evaluated in double precision from the keys, on the side that the
// ray leaves to, and not further away than a few roundings of the coordinates.
TEST_CASE("spawned rays start beyond the surface, at coordinates of 1e4") {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f), small(-1.0f, 1.0f), large(-1e4f, 1e4f);
  const auto small_vector = [&] { return Vec3f{small(random), small(random), small(random)}; };
  for (int round = 0; round < 20000; ++round) {
    const bool instanced = round % 2 == 1;
    Affine3f a{small_vector(), small_vector(), small_vector(), {large(random), large(random), large(random)}};
    Affine3f b = a;
    b.t += small_vector() * 10.0f;
    if (std::abs(a.determinant()) < 0.05f) continue;
    Scene scene = instanced ? instanced_scene(1, {a, b}) : triangle_scene();
    TriangleMesh& shape = scene.meshes[0].shape;
    shape.segments = 1;
    const Vec3f place = instanced ? Vec3f{} : Vec3f{large(random), large(random), large(random)};
    shape.positions.clear();
    for (int i = 0; i < 6; ++i) shape.positions.push_back(place + small_vector());

    const float time = unit(random), v = unit(random), u = (1.0f - v) * unit(random);
    Ray ray;
    ray.dir = small_vector();
    ray.time = time;
    const Hit hit{.u = u, .v = v, .triangle = 0, .instance = instanced ? 0 : kNoInstance};
    ray.org = surface(scene, hit, ray).position - ray.dir * 3.0f;
    const SurfaceHit point = surface(scene, hit, ray);
    if (point.origin.beside_edge) continue;

    const double w = time;
    Vec3d corner[3];
    for (int i = 0; i < 3; ++i) {
      corner[i] = lerp(Vec3d(shape.positions[i]), Vec3d(shape.positions[i + 3]), w);
      if (instanced) corner[i] = lerp(Affine3d(a), Affine3d(b), w).point(corner[i]);
    }
    const Vec3d normal = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double side = dot(normal, Vec3d(point.geometric_normal)) > 0 ? 1.0 : -1.0;
    for (const float leaving : {1.0f, -1.0f}) {
      const Vec3f direction = point.geometric_normal * leaving;
      const Vec3d from_corner = Vec3d(leave(point, direction, time).org) - corner[0];
      const double height = dot(normal, from_corner) * side * leaving;
      CHECK(height > 0.0);
      CHECK(height < 0.1);
    }
  }
}

}  // namespace
}  // namespace msbvh
