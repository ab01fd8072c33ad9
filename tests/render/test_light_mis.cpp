// Multiple importance sampling against brute force: for each setup of lights and surfaces the same light by
// samples of the lights alone, by scattered rays alone, and as the renderer takes both together.
#include <random>
#include <string>

#include "core/api/scene_trees.h"
#include "core/integrate/looks.h"
#include "core/shade/material/surface_values.h"
#include "tests/render/pictures.h"
#include "tests/support/scalar_path_tracer.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 8;

struct Setup {
  std::string name;
  Scene scene;
};

struct Lit {
  explicit Lit(const std::shared_ptr<const Scene>& scene)
      : trees(scene, {}, nullptr), frame(frame_of(*scene, trees.world().bvh())) {}

  static Frame frame_of(const Scene& scene, const Bvh& world) {
    Box3f bounds;
    for (const Box3f& b : world.root_bounds) bounds.grow(b);
    return {SceneIndex(scene),
            LightSampler(scene, bounds),
            world,
            Tracer(world),
            kSize,
            kSize,
            7,
            0,
            true,
            {},
            nullptr,
            choose_stages({}, {}, world),
            {},
            {}};
  }

  SceneTrees trees;
  Frame frame;
};

// Light that the first surface reflects, by one sample of one way.
class OneWay {
 public:
  explicit OneWay(const Frame& frame) : frame_(frame) {}

  // By each light's own sample.
  double by_lights(std::uint32_t x, std::uint32_t y, std::uint32_t s) const {
    Vertex v;
    if (!find(x, y, s, v)) return 0.0;
    double sum = 0.0;
    const Sampler sampler(v.pixel, s);
    for (std::uint32_t i = 0; i < frame_.scene().lights.size(); ++i) {
      const Light& light = frame_.scene().lights[i];
      if (!holds_group(light.lit_groups, v.light_group)) continue;
      LightSample sample;
      const Point2 random = sampler.pair(Dimension::kLight, 0, i);
      if (!sampled(light, i, v, random, sample)) continue;
      if (dot(sample.direction, v.surface.geometric_normal) <= 0.0f) continue;
      const Bsdf::Value reflected = v.bsdf.at(v.surface.shading_normal, sample.direction);
      if (!(reflected.pdf > 0.0f)) continue;
      Ray ray = leave(v.surface, sample.direction, v.ray.time);
      ray.tfar = sample.distance;
      Hit hit;
      if (!frame_.tracer.intersect(ray, hit)) sum += double((reflected.both() * sample.irradiance).x);
    }
    return sum;
  }

  // By the surface's own.
  double by_surface(std::uint32_t x, std::uint32_t y, std::uint32_t s) const {
    Vertex v;
    if (!find(x, y, s, v)) return 0.0;
    const Sampler sampler(v.pixel, s);
    const BsdfSample sample = v.bsdf.sample(v.surface.shading_normal, sampler.pair(Dimension::kLobe, 0).x,
                                            sampler.pair(Dimension::kBounce, 0));
    if (!(sample.pdf > 0.0f) || dot(sample.direction, v.surface.geometric_normal) <= 0.0f) return 0.0;
    const Ray ray = leave(v.surface, sample.direction, v.ray.time);
    Hit hit;
    const bool found = frame_.tracer.intersect(ray, hit);
    Vec3f sum = found ? Vec3f{} : frame_.lights.dome_radiance(ray.time);
    for (const Light& light : frame_.scene().lights) {
      if (!holds_group(light.lit_groups, v.light_group)) continue;
      LightAlong along;
      if (light.kind == LightKind::kMesh) {
        const LightPick* met = found ? frame_.lights.mesh_at(frame_.index.resolve(hit)) : nullptr;
        if (met && met->light == &light) sum += values_at(light, ray.time).radiance;
      } else if (find_light(light, v.surface.position, ray.dir, ray.time, along) &&
                 (!found || hit.t > along.distance)) {
        sum += along.radiance;
      }
    }
    return double((sample.weight * sum).x);
  }

 private:
  struct Vertex {
    PixelSampler pixel{0, 0, 0};
    Ray ray;
    SurfaceHit surface;
    Bsdf bsdf;
    std::uint32_t light_group = 0;
  };

  bool find(std::uint32_t x, std::uint32_t y, std::uint32_t s, Vertex& v) const {
    v.pixel = PixelSampler(frame_.seed, x, y);
    v.ray = camera_sample_ray(frame_, v.pixel, x, y, s);
    Hit hit;
    if (!frame_.tracer.intersect(v.ray, hit)) return false;
    const HitSource source = frame_.index.resolve(hit);
    v.light_group = source.light_group();
    v.surface = surface_at(frame_.scene(), source, hit, v.ray);
    const Material& material = *material_at(frame_.scene(), material_index(source, hit));
    const SurfaceLook look = apply_material(material, source, hit, v.ray.time, {}, {}, v.surface);
    v.bsdf = Bsdf(look, v.surface.shading_normal, normalize(-v.ray.dir));
    return clear_origin(frame_.surroundings(), v.ray, v.surface.origin);
  }

  bool sampled(const Light& light, std::uint32_t i, const Vertex& v, Point2 random,
               LightSample& sample) const {
    if (light.kind != LightKind::kMesh)
      return sample_light(light, frame_.scene().camera, v.surface.position, v.ray.time, random, sample);
    return frame_.lights.pick(i).mesh->sample(v.surface, values_at(light, v.ray.time), v.ray.time, random,
                                              sample);
  }

  const Frame& frame_;
};

Light above(LightKind kind, const Vec3f& place) {
  Light light;
  light.name = "/lamp";
  light.kind = kind;
  light.radiance = {2, 2, 2};
  light.world_from_light = {translation(place)};
  return light;
}

// A floor under a card that hides half of what is above from some of it. Roughness 0: it is diffuse.
Scene floor_with(float roughness, const std::vector<Light>& lights) {
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  scene.materials = {{.name = "/floor",
                      .diffuse_color = {0.5f, 0.5f, 0.5f},
                      .specular = roughness > 0.0f,
                      .metallic = 0.5f,
                      .roughness = roughness}};
  Mesh floor = polygon({rectangle(-9, -9, 18, 18)}), card = polygon({rectangle(-5, 2, -0.5f, 6, 1.5f)});
  floor.material = card.material = 0;
  add(scene, floor);
  add(scene, card);
  scene.lights = lights;
  return scene;
}

Light image_dome() {
  Light sky = above(LightKind::kDome, {});
  std::vector<Vec3f> texels;
  for (int i = 0; i < 32; ++i) texels.push_back(Vec3f{1, 1, 1} * float(i * 7 % 11));
  sky.image = light_image("sky", ImageMap::kLatlong, 8, 4, std::move(texels));
  return sky;
}

Scene with_mesh_light(float roughness) {
  Light lamp = above(LightKind::kMesh, {});
  lamp.surface = {2};
  Scene scene = floor_with(roughness, {lamp});
  Mesh sheet = polygon({rectangle(9, 0, 13, 5, 3), rectangle(10, 2, 17, 8, 4)});
  sheet.material = 0;
  add(scene, sheet);
  return scene;
}

std::vector<Setup> setups() {
  std::vector<Setup> all;
  Light sun = above(LightKind::kDistant, {});
  sun.angle_degrees = 30.0f;
  all.push_back({"distant, diffuse", floor_with(0.0f, {sun})});
  Light bulb = above(LightKind::kSphere, {-1, 4, 4});
  bulb.radius = 0.4f;
  bulb.radiance = {90, 90, 90};
  all.push_back({"small sphere, smooth", floor_with(0.35f, {bulb})});
  Light globe = above(LightKind::kSphere, {-4, 4, 5});
  globe.radius = 3.0f;
  all.push_back({"large sphere, rough", floor_with(0.8f, {globe})});
  Light panel = above(LightKind::kRect, {-2, 4, 3});
  panel.width = panel.height = 7.0f;
  all.push_back({"large rect, smooth", floor_with(0.3f, {panel})});
  Light spot = above(LightKind::kDisk, {-1, 4, 5});
  spot.radius = 2.0f;
  spot.cone_angle_degrees = 50.0f;
  spot.cone_softness = 0.5f;
  all.push_back({"disk with a cone, rough", floor_with(0.6f, {spot})});
  Light tube = above(LightKind::kCylinder, {0, 4, 3});
  tube.radius = 0.5f;
  tube.length = 6.0f;
  all.push_back({"cylinder, diffuse", floor_with(0.0f, {tube})});
  Light screen = panel;
  screen.image = light_image("screen", ImageMap::kRect, 2, 2, {{0, 0, 0}, {1, 1, 1}, {5, 5, 5}, {2, 2, 2}});
  all.push_back({"textured rect, smooth", floor_with(0.4f, {screen})});
  all.push_back({"textured dome, rough", floor_with(0.7f, {image_dome()})});
  Light guided = image_dome();
  guided.portals = {{5.0f, 5.0f, 0, {translation({-2, 4, 4})}}};
  all.push_back({"dome with a portal, diffuse", floor_with(0.0f, {guided})});
  all.push_back({"moving mesh, diffuse", with_mesh_light(0.0f)});
  all.push_back({"moving mesh, smooth", with_mesh_light(0.4f)});
  Light other = panel, swinging = spot;
  other.lit_groups = {0, 1};
  swinging.segments = 1;
  swinging.world_from_light.push_back(translation({6, 4, 3}));
  Scene linked = floor_with(0.5f, {other, swinging, bulb, sun, tube, globe});
  linked.meshes[1].light_group = 1;
  for (Light& light : linked.lights) light.lit_groups.resize(2, 1);
  linked.lights[0].lit_groups = {0, 1};
  all.push_back({"linked, moving, by chance", linked});
  return all;
}

void expect_equal(const Estimates& a, const Estimates& b) {
  CAPTURE(a.mean());
  CAPTURE(b.mean());
  const double sigma = std::hypot(a.sigma(), b.sigma());
  CAPTURE(sigma);
  CHECK(std::abs(a.mean() - b.mean()) <= 4.0 * sigma + kSinglePrecision);
}

TEST_CASE("lights alone, scattered rays alone and both by MIS give the same light") {
  constexpr std::uint32_t kSamples = 1200, kSeeds = 16;
  for (const Setup& setup : setups()) {
    CAPTURE(setup.name);
    const auto scene = std::make_shared<const Scene>(setup.scene);
    const Lit lit(scene);
    const OneWay one_way(lit.frame);
    Estimates lights, surface, both;
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      double by_lights = 0.0, by_surface = 0.0;
      for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
        by_lights += one_way.by_lights(i % kSize, i / kSize, s) / (kSize * kSize);
        by_surface += one_way.by_surface(i % kSize, i / kSize, s) / (kSize * kSize);
      }
      lights.add(by_lights);
      surface.add(by_surface);
    }
    for (std::uint32_t seed = 100; seed < 100 + kSeeds; ++seed) {
      const Image image = render(*scene, {.width = kSize,
                                          .height = kSize,
                                          .spp = 48,
                                          .seed = seed,
                                          .max_bounces = 0,
                                          .show_domes = false,
                                          .build = {}});
      double sum = 0.0;
      for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i] / (kSize * kSize);
      both.add(sum);
    }
    CHECK(both.mean() > 0.0);
    expect_equal(lights, surface);
    expect_equal(lights, both);
    expect_equal(surface, both);
  }
}

// A square that shines, beside the picture; and the rectangle of the same place, which is drawn by its own
// code.
TEST_CASE("a square mesh light draws the picture of a rect light") {
  Scene square = floor_with(0.0f, {});
  square.world.pop_back();
  Scene panel = square;
  Mesh sheet = polygon({rectangle(9, 2, 13, 6, 2)});
  sheet.material = 0;
  add(square, sheet);
  square.lights = {above(LightKind::kMesh, {})};
  square.lights[0].surface = {2};
  panel.lights = {above(LightKind::kRect, {11, 4, 2})};
  panel.lights[0].width = panel.lights[0].height = 4.0f;
  std::array<Estimates, kSize * kSize> of_square, of_panel;
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 64, .max_bounces = 0, .build = {}};
  for (settings.seed = 0; settings.seed < 16; ++settings.seed) {
    const Image a = render(square, settings), b = render(panel, settings);
    for (std::size_t i = 0; i < of_square.size(); ++i) {
      of_square[i].add(a.rgba[4 * i]);
      of_panel[i].add(b.rgba[4 * i]);
    }
  }
  for (std::size_t i = 0; i < of_square.size(); ++i) {
    const double sigma = std::hypot(of_square[i].sigma(), of_panel[i].sigma());
    CAPTURE(i);
    CHECK(std::abs(of_square[i].mean() - of_panel[i].mean()) <= 5.0 * sigma + kSinglePrecision);
    CHECK(sigma < 0.02 * of_panel[i].mean());
  }
}

// What glows is seen by the camera as its material has it; as a light it is not counted twice.
TEST_CASE("behind the first surface a mesh light gives its light once, whatever its material glows") {
  Scene scene = with_mesh_light(0.0f);
  const RenderSettings settings{.width = kSize, .height = kSize, .spp = 16, .max_bounces = 2, .build = {}};
  const Image dark = render(scene, settings);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emissive_color = {50, 50, 50};
  scene.meshes[2].material = 1;
  CHECK(render(scene, settings).rgba == dark.rgba);
  scene.camera.world_from_camera = {translation({9, 2, 100})};
  CHECK(channel(render(scene, settings), 4, 4, 0) > 10.0f);
}

}  // namespace
}  // namespace msbvh
