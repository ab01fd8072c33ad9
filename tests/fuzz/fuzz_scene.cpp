// The gate of a whole scene. What passes it is built, verified, probed and drawn; no pixel is NaN.
#include <cmath>
#include <memory>
#include <utility>

#include "core/api/renderer.h"
#include "core/scene/scene.h"
#include "tests/fuzz/fuzzed_shapes.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;

namespace {

// Of the translator: it lets no brighter colour pass (delegate/translate/primvars.h).
constexpr float kMaxColor = 65504.0f;

Vec3f color(FuzzedData& data) {
  const auto channel = [&] {
    return data.wrong() ? data.real32() : data.rarely() ? kMaxColor : float(data.unit());
  };
  return {channel(), channel(), channel()};
}

template <typename T, typename Shape, typename Value>
Primvar<T> fuzzed_primvar(FuzzedData& data, const Shape& shape, const Value& value) {
  Primvar<T> primvar;
  if (data.coin()) return primvar;
  primvar.interpolation =
      data.one_of({Interpolation::kConstant, Interpolation::kTriangle, Interpolation::kVertex});
  if (data.wrong()) primvar.interpolation = Interpolation::kFaceVarying;
  primvar.segments = data.one_of({0u, 1u, 2u});
  if (data.wrong()) primvar.segments = 3;
  std::size_t count = 0;
  if (!is_valid_form(shape.form())) return primvar;
  accepted([&] { return count = value_count(primvar.interpolation, shape); });
  const T first = value();
  primvar.values.assign(std::min<std::size_t>(1000, key_count(primvar.segments) * count), first);
  if (!primvar.values.empty()) primvar.values.back() = value();
  if (data.wrong()) primvar.values.resize(primvar.values.size() + 1, first);
  return primvar;
}

template <typename Look>
void dress(Look& look, FuzzedData& data, std::size_t materials) {
  look.display_color = fuzzed_primvar<Vec3f>(data, look.shape, [&] { return color(data); });
  look.display_opacity = fuzzed_primvar<float>(
      data, look.shape, [&] { return data.wrong() ? data.real32() : float(data.unit()); });
  if (materials > 0 && data.coin()) look.material = data.below(std::uint32_t(materials));
  if (data.wrong()) look.material = data.number32();
}

// What a material reads, from what the scene has and from what it has not.
void add_reads(Material& material, Scene& scene, FuzzedData& data) {
  if (scene.textures.empty()) {
    scene.textures = {{.name = "a.png", .tiles = {{0, 0, {"/a.png"}}}}};
    scene.primvar_names = {"st", "wet"};
  }
  TextureRead read{.texture = data.wrong() ? 1u : 0u, .coordinates = data.below(data.wrong() ? 3 : 2)};
  if (data.wrong()) read.matrix[data.below(4)] = data.real32();
  material.texture_reads = {read};
  const auto input = [&] { return SurfaceInput(data.below(10)); };
  const std::uint8_t channel = data.wrong() ? 3 : 0;
  material.driven = {{input(), DrivenInput::Source::kTexture, data.wrong() ? 1u : 0u, channel, data.coin()},
                     {input(), DrivenInput::Source::kPrimvar, data.below(2)}};
}

void add_materials(Scene& scene, FuzzedData& data) {
  for (std::uint32_t n = data.below(3); n > 0; --n) {
    Material material;
    material.diffuse_color = color(data);
    material.diffuse_from_display_color = data.coin();
    if (data.rarely()) material.emissive_color = color(data);
    material.opacity = data.wrong() ? data.real32() : float(data.unit());
    material.opacity_from_display_opacity = data.coin();
    material.opacity_threshold = data.coin() ? 0.0f : float(data.unit());
    material.roughness = data.wrong() ? data.real32() : float(data.unit());
    material.specular = data.coin();
    material.transparent_reflects = data.coin();
    if (data.coin()) add_reads(material, scene, data);
    scene.materials.push_back(material);
  }
}

void add_geometry(Scene& scene, FuzzedData& data) {
  const std::size_t materials = scene.materials.size();
  const auto per = [&](std::size_t count) {
    std::vector<std::uint32_t> values;
    if (data.rarely()) values = data.indices(count + (data.wrong() ? 1 : 0), std::uint32_t(materials));
    if (materials == 0) values.assign(values.size(), kNone);
    return values;
  };
  for (std::uint32_t n = data.below(3); n > 0; --n) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.shape = fuzzed_mesh(data);
    if (is_valid_form(mesh.shape.form()) && !data.wrong())
      mesh.shape.positions.resize(mesh.shape.position_count() + TriangleMesh::kGuard);
    dress(mesh, data, materials);
    mesh.normals = fuzzed_primvar<Vec3f>(data, mesh.shape, [&] {
      return Vec3f{data.real32(), data.real32(), data.real32()};
    });
    mesh.triangle_materials = per(mesh.shape.triangles.size());
  }
  for (std::uint32_t n = data.below(2); n > 0; --n) {
    Grids& grids = scene.grids.emplace_back();
    grids.shape = fuzzed_grids(data);
    dress(grids, data, materials);
    grids.grid_materials = per(grids.shape.grids.size());
  }
  for (std::uint32_t n = data.below(2); n > 0; --n) {
    Curves& curves = scene.curves.emplace_back();
    curves.fibre = data.coin();
    curves.shape = fuzzed_curves(data);
    dress(curves, data, materials);
  }
  for (std::uint32_t n = data.below(2); n > 0; --n) {
    Points& points = scene.points.emplace_back();
    points.shape = fuzzed_points(data);
    dress(points, data, materials);
  }
}

std::vector<GeometryId> some_geometry(const Scene& scene, FuzzedData& data) {
  std::vector<GeometryId> ids;
  const auto add = [&](GeometryKind kind, std::size_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!data.rarely()) ids.push_back({kind, i});
    }
  };
  add(GeometryKind::kTriangleMesh, scene.meshes.size());
  add(GeometryKind::kGridMesh, scene.grids.size());
  add(GeometryKind::kCurves, scene.curves.size());
  add(GeometryKind::kPoints, scene.points.size());
  if (data.wrong()) ids.push_back({GeometryKind(data.below(8)), data.below(4)});
  return ids;
}

std::size_t controls_of(const TrackForm& form) { return is_valid_form(form) ? form.controls() : 2; }

void add_instances(Scene& scene, FuzzedData& data) {
  for (std::uint32_t n = data.below(3); n > 0; --n) {
    scene.prototypes.push_back({"/prototype", some_geometry(scene, data), fuzzed_time_remap(data)});
  }
  const auto prototypes = std::uint32_t(scene.prototypes.size());
  for (std::uint32_t n = prototypes == 0 ? 0 : data.below(3); n > 0; --n) {
    InstanceSet& set = scene.instances.emplace_back();
    set.name = "/instances";
    set.prototype = data.wrong() ? data.number32() : data.below(prototypes);
    const TrackForm form = fuzzed_form(data);
    set.segments = form.segments;
    set.degree = form.degree;
    const std::uint32_t count = fuzzed_count(data, form, 4);
    const Affine3f first = data.map();
    for (std::size_t i = 0; i < count * controls_of(form); ++i)
      set.world_from_prototype.push_back(data.coin() ? first : data.map());
    if (data.wrong()) set.world_from_prototype.push_back(first);
    set.time_remap = fuzzed_time_remap(data);
    if (data.rarely()) set.display_color.assign(count, color(data));
    if (data.rarely() && !scene.materials.empty()) set.materials.assign(count, 0);
  }
}

void add_lights(Scene& scene, FuzzedData& data) {
  for (std::uint32_t n = data.below(3); n > 0; --n) {
    Light& light = scene.lights.emplace_back();
    light.name = "/light";
    light.kind = LightKind(data.below(7));
    light.segments = data.wrong() ? 3 : data.one_of({0u, 1u, 4u});
    const auto values = [&] {
      LightValues v;
      v.radiance = color(data);
      v.radius = data.coin() ? float(data.unit()) : std::abs(data.real32());
      v.angle_degrees = float(360.0 * data.unit());
      v.width = float(data.unit());
      v.height = data.wrong() ? data.real32() : float(data.unit());
      v.length = float(data.unit());
      v.cone_angle_degrees = data.coin() ? 180.0f : float(180.0 * data.unit());
      v.focus = data.coin() ? 0.0f : std::abs(data.real32());
      v.diffuse = float(data.unit());
      return v;
    };
    static_cast<LightValues&>(light) = values();
    if (light.kind == LightKind::kDome && data.coin())
      light.image =
          light_image("image", ImageMap(1 + data.below(3)), 2, 1, {{float(data.unit()), 0, 1}, {1, 0, 0}});
    light.shadow.distance = data.coin() ? -1.0f : float(data.unit());
    light.shadow.falloff = data.coin() ? -1.0f : float(data.unit());
    for (std::uint32_t i = 0; i < key_count(light.segments); ++i)
      light.world_from_light.push_back(data.map());
    for (std::uint32_t i = 0; i < key_count(light.segments) && data.coin(); ++i)
      light.moving_values.push_back(values());
    if (light.moving_values.size() != light.world_from_light.size() && !data.wrong())
      light.moving_values.clear();
    if (data.wrong()) light.world_from_light.pop_back();
  }
}

Camera fuzzed_camera(FuzzedData& data) {
  Camera camera;
  camera.name = "/camera";
  camera.projection = data.one_of({Projection::kPerspective, Projection::kOrthographic});
  const TrackForm form = data.coin() ? TrackForm{} : fuzzed_form(data);
  camera.segments = form.segments;
  camera.degree = form.degree;
  const bool lens = camera.projection == Projection::kPerspective ? data.rarely() : data.wrong();
  Affine3f at;
  at.t = {0, 0, 5};
  if (data.rarely()) at = data.map();
  for (std::size_t i = 0; i < controls_of(form); ++i) {
    camera.world_from_camera.push_back(data.rarely() ? data.map() : at);
    ScreenWindow window;
    if (data.rarely()) window = {data.real32(), data.real32(), data.real32(), data.real32()};
    camera.window.push_back(window);
    if (lens) camera.lens.push_back({float(data.unit()), float(data.positive())});
  }
  camera.near_clip = data.rarely() ? data.real32() : 0.1f;
  camera.far_clip = data.rarely() ? data.real32() : 1e6f;
  camera.time_remap = fuzzed_time_remap(data);
  return camera;
}

void draw(const std::shared_ptr<const Scene>& scene, FuzzedData& data) {
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.spp = 1 + data.below(2);
  settings.seed = data.byte();
  settings.max_bounces = data.below(3);
  settings.threads = 1;
  settings.refraction = data.coin();
  settings.build.layout = data.one_of({TreeLayout::kFull, TreeLayout::kCompact});
  Renderer renderer;
  if (!passes([&] { renderer.commit(scene, settings); })) return;
  renderer.verify();
  const Image image = renderer.render();
  for (const float value : image.rgba) require(!std::isnan(value), "a pixel that is not a number");
  ProbeSettings probe;
  probe.rays = 4;
  probe.oracle_tests = 500;
  for (const ProbeResult& result : renderer.probe(probe).results) {
    if (result.wrong > 0) fail(result.probe + ": " + result.first);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  auto scene = std::make_shared<Scene>();
  scene->camera = fuzzed_camera(data);
  add_materials(*scene, data);
  add_geometry(*scene, data);
  scene->world = some_geometry(*scene, data);
  add_instances(*scene, data);
  add_lights(*scene, data);
  // The trees of instances are the core's own: reach is not known here, but sizes are.
  if (data.largest() > 1e6) scene->instances.clear();
  if (passes([&] { validate(*scene); })) draw(scene, data);
  return 0;
}
