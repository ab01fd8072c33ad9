#include <cmath>
#include <doctest/doctest.h>

#include "core/shade/surface_hit.h"

namespace msbvh {
namespace {

// A straight tube or ribbon of radius 0.5 along x, from x = 0 to 3.
Scene curve_scene(CurveShape shape) {
  Scene scene;
  Curves curves;
  curves.shape.shape = shape;
  curves.shape.vertex_count = 4;
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) curves.shape.vertices.push_back({{x, 0, 0}, 0.5f});
  if (shape == CurveShape::kOriented) curves.shape.normals.assign(4, {0.5f, 0, 2});
  curves.shape.spans = {0};
  scene.curves = {curves};
  scene.world = {curves_id(0)};
  return scene;
}

Scene point_scene() {
  Scene scene;
  Points points;
  points.shape.point_count = 2;
  points.shape.vertices = {{{9, 9, 9}, 1.0f}, {{0, 0, 1}, 2.0f}};
  scene.points = {points};
  scene.world = {points_id(0)};
  return scene;
}

SurfaceHit surface(const Scene& scene, const Hit& hit, const Ray& ray) {
  return surface_at(scene, SceneIndex(scene).resolve(hit), hit, ray);
}

void check_near(const Vec3f& found, const Vec3f& expected) {
  CAPTURE(found.x);
  CAPTURE(found.y);
  CAPTURE(found.z);
  CHECK(length(found - expected) < 1e-6f);
}

Hit on_curve(float t, float u, float v = 0.0f) {
  return {.t = t, .u = u, .v = v, .triangle = 0, .geometry = curves_id(0)};
}

Ray down_at(float x, float y) { return {.org = {x, y, 4}, .dir = {0, 0, -1}}; }

TEST_CASE("a ribbon turned to the ray is shaded as a tube") {
  const Scene scene = curve_scene(CurveShape::kRibbon);
  const SurfaceHit middle = surface(scene, on_curve(4, 0.5f), down_at(1.5f, 0));
  check_near(middle.geometric_normal, {0, 0, 1});
  check_near(middle.shading_normal, {0, 0, 1});
  const SurfaceHit aside = surface(scene, on_curve(4, 0.5f, 0.6f), down_at(1.5f, 0.3f));
  check_near(aside.geometric_normal, {0, 0.6f, 0.8f});
  check_near(aside.shading_normal, {0, 0.6f, 0.8f});
  check_near(aside.position, {1.5f, 0.3f, 0.4f});
}

TEST_CASE("rays that leave a ribbon start on the tube that it stands for, clear of it") {
  const Scene scene = curve_scene(CurveShape::kRibbon);
  const SurfaceHit hit = surface(scene, on_curve(4, 0.5f, 0.6f), down_at(1.5f, 0.3f));
  const Ray up = leave(hit, {0, 0, 1}, 0), through = leave(hit, {0, 0, -1}, 0);
  CHECK(std::hypot(up.org.y, up.org.z) > 0.5f);
  CHECK(std::hypot(up.org.y, up.org.z) < 0.51f);
  CHECK(std::hypot(through.org.y, through.org.z) > 0.5f);
  CHECK(through.org.z < 0.0f);
}

TEST_CASE("a place that errs along a hair does not tilt its normal") {
  for (const float error : {-1e-4f, 0.0f, 1e-4f}) {
    for (const CurveShape shape : {CurveShape::kRibbon, CurveShape::kTube}) {
      const Scene even = curve_scene(shape);
      const float way = shape == CurveShape::kTube ? 3.6f : 4.0f;
      const SurfaceHit hit = surface(even, on_curve(way, 0.5f + error, 0.6f), down_at(1.5f, 0.3f));
      check_near(hit.geometric_normal, {0, 0.6f, 0.8f});
    }
    Scene cone = curve_scene(CurveShape::kTube);  // its radius grows by 1/6 of the way
    for (RoundVertex& v : cone.curves[0].shape.vertices) v.radius += v.p.x / 6.0f;
    const float back = 1.0f / 6.0f, up = std::sqrt(1.0f - back * back);
    const Hit touched = on_curve(4.0f - 0.75f * up, 0.5f + error);
    const SurfaceHit hit = surface(cone, touched, down_at(1.5f - 0.75f * back, 0.0f));
    // Its radius is that of the place, an error of 1e-4 off: 1.1e-5 of the normal, which was 4e-4.
    CHECK(length(hit.geometric_normal - Vec3f{-back, 0, up}) < 2e-5f);
  }
}

TEST_CASE("a tube's normal leads from its centre line, its ends included") {
  const Scene scene = curve_scene(CurveShape::kTube);
  const SurfaceHit hit = surface(scene, on_curve(3.6f, 0.5f), down_at(1.5f, 0.3f));
  check_near(hit.geometric_normal, {0, 0.6f, 0.8f});
  check_near(hit.shading_normal, hit.geometric_normal);
  check_near(hit.position, {1.5f, 0.3f, 0.4f});
  // The ball at the end.
  const Ray along{.org = {-4, 0.3f, 0}, .dir = {1, 0, 0}};
  check_near(surface(scene, on_curve(3.6f, 0.0f), along).geometric_normal, {-0.8f, 0.6f, 0});
}

TEST_CASE("an oriented ribbon has its own normal, across its line, on the ray's side") {
  const Scene scene = curve_scene(CurveShape::kOriented);
  check_near(surface(scene, on_curve(4, 0.5f), down_at(1.5f, 0.3f)).geometric_normal, {0, 0, 1});
  const Ray up{.org = {1.5f, 0, -4}, .dir = {0, 0, 1}};
  check_near(surface(scene, on_curve(4, 0.5f), up).geometric_normal, {0, 0, -1});
}

TEST_CASE("a point is a ball, from outside and from inside") {
  const Scene scene = point_scene();
  const Hit hit{.t = 1, .triangle = 1, .geometry = points_id(0)};
  const SurfaceHit outside = surface(scene, hit, down_at(0, 0));
  check_near(outside.geometric_normal, {0, 0, 1});
  check_near(outside.position, {0, 0, 3});
  CHECK(outside.origin.before.z > 3.0f);
  const Ray from_inside{.org = {0, 0, 1}, .dir = {0, 0, 2}};
  const SurfaceHit inside = surface(scene, hit, from_inside);
  check_near(inside.geometric_normal, {0, 0, -1});
  check_near(inside.position, {0, 0, 3});
  CHECK(inside.origin.before.z < 3.0f);
}

TEST_CASE("through an instance that mirrors and stretches") {
  Scene scene = point_scene();
  scene.world.clear();
  scene.prototypes = {{"/prototype", {points_id(0)}}};
  scene.instances = {{"/instances", 0, 0, {Affine3f{{3, 0, 0}, {0, 1, 0}, {0, 0, -1}, {5, 0, 0}}}, {}}};
  // The ball about (0, 0, 1) is an ellipsoid about (5, 0, -1), 12 long in x.
  const Ray ray{.org = {5, 0, 2}, .dir = {0, 0, -1}};
  const SurfaceHit top =
      surface(scene, {.t = 1, .triangle = 1, .geometry = points_id(0), .instance = 0}, ray);
  check_near(top.position, {5, 0, 1});
  check_near(top.geometric_normal, {0, 0, 1});
  const float r = std::sqrt(2.0f);  // the ball's point at 45 degrees, below: (r, 0, 1 - r)
  const Ray down{.org = {5 + 3 * r, 0, 4}, .dir = {0, 0, -1}};
  const Hit side{.t = 5 - r, .triangle = 1, .geometry = points_id(0), .instance = 0};
  check_near(surface(scene, side, down).position, {5 + 3 * r, 0, r - 1});
  check_near(surface(scene, side, down).geometric_normal, normalize(Vec3f{1.0f / 3, 0, 1}));
}

TEST_CASE("centre lines and radii move") {
  Scene scene = point_scene();
  PointSet& shape = scene.points[0].shape;
  shape.segments = 1;
  shape.vertices.insert(shape.vertices.end(), {{{0, 0, 0}, 1.0f}, {{0, 0, 3}, 4.0f}});
  Ray ray = down_at(0, 0);
  ray.org.z = 10;
  ray.time = 0.5f;
  const Hit hit{.t = 5, .triangle = 1, .geometry = points_id(0)};
  check_near(surface(scene, hit, ray).position, {0, 0, 5});
}

TEST_CASE("primvars on curves and points") {
  Scene scene = curve_scene(CurveShape::kRibbon);
  Curves& curves = scene.curves[0];
  CHECK(surface(scene, on_curve(4, 0.5f), down_at(1.5f, 0)).albedo == Vec3f{0.18f, 0.18f, 0.18f});
  curves.display_color.interpolation = Interpolation::kTriangle;
  curves.display_color.values = {{0.1f, 0.2f, 0.3f}};
  CHECK(surface(scene, on_curve(4, 0.5f), down_at(1.5f, 0)).albedo == Vec3f{0.1f, 0.2f, 0.3f});
  curves.display_color.interpolation = Interpolation::kVertex;
  curves.display_color.values = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}};
  CHECK(surface(scene, on_curve(4, 0.5f), down_at(1.5f, 0)).albedo == Vec3f{0.125f, 0.125f, 0.125f});

  scene = point_scene();
  scene.points[0].display_color.interpolation = Interpolation::kTriangle;
  scene.points[0].display_color.values = {{1, 0, 0}, {0, 1, 0}};
  const Hit hit{.t = 1, .triangle = 1, .geometry = points_id(0)};
  CHECK(surface(scene, hit, down_at(0, 0)).albedo == Vec3f{0, 1, 0});
  scene.points[0].display_opacity.values = {0.25f};
  CHECK(opacity_at(scene, SceneIndex(scene).resolve(hit), hit, 0.0f) == 0.25f);
}

TEST_CASE("ids of a tree count each kind apart") {
  Scene scene = curve_scene(CurveShape::kTube);
  scene.curves.push_back(scene.curves[0]);
  scene.points = point_scene().points;
  scene.meshes.resize(2);
  scene.world = {mesh_id(1), curves_id(1), points_id(0)};
  scene.prototypes = {{"/prototype", {mesh_id(0), curves_id(0), curves_id(1), points_id(0)}}};
  scene.instances = {{"/instances", 0, 0, {Affine3f{}}, {}}};
  const SceneIndex index(scene);
  const auto resolve = [&](GeometryId id, std::uint32_t instance) {
    return index.resolve({.geometry = id, .instance = instance});
  };
  CHECK(resolve(mesh_id(0), kNoInstance).mesh == &scene.meshes[1]);
  CHECK(resolve(curves_id(0), kNoInstance).curves == &scene.curves[1]);
  CHECK(resolve(points_id(0), kNoInstance).points == &scene.points[0]);
  CHECK(resolve(curves_id(1), 0).curves == &scene.curves[1]);
  CHECK(resolve(points_id(0), 0).look == &scene.points[0]);
  CHECK(resolve(mesh_id(0), 0).curves == nullptr);
}

}  // namespace
}  // namespace msbvh
