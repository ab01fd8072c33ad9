#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/scene/check_light.h"
#include "core/scene/check_material.h"
#include "core/scene/gate.h"

namespace msbvh {
namespace {

using namespace gate;

// A part of the scene in messages: its name, or its kind and index where it has none.
std::string label(const std::string& name, const char* kind, std::size_t index) {
  return name.empty() ? std::string(kind) + " " + std::to_string(index) : name;
}

void expect_time_remap(const TimeRemap& time_remap, const std::string& part) {
  expect(is_valid_time_remap(time_remap), part, "time_remap",
         std::to_string(time_remap.pieces.size()) + " pieces",
         "pieces that begin at 0 and increase, with local times in [0, 1] that do not decrease");
}

template <typename T>
void expect_curve(const std::vector<T>& controls, const TrackForm& form, const std::string& part,
                  const std::string& attribute) {
  expect_segments(form.segments, part, attribute);
  expect(is_valid_form(form), part, attribute, "degree " + std::to_string(form.degree),
         "1 to " + std::to_string(kMaxDegree) + ", and 1 for a still track");
  expect(controls.size() == form.controls(), part, attribute, std::to_string(controls.size()) + " controls",
         std::to_string(form.controls()));
  expect_all_finite(controls, part, attribute);
}

std::size_t count_of(GeometryKind kind, const Scene& scene) {
  switch (kind) {
    case GeometryKind::kTriangleMesh:
      return scene.meshes.size();
    case GeometryKind::kCurves:
      return scene.curves.size();
    case GeometryKind::kPoints:
      return scene.points.size();
    case GeometryKind::kGridMesh:
      return scene.grids.size();
  }
  return 0;
}

void expect_geometry(const std::vector<GeometryId>& list, const Scene& scene, const std::string& part,
                     const std::string& attribute) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    expect_index(list[i].index(), count_of(list[i].kind(), scene), part, attribute);
    expect(i == 0 || list[i - 1].kind() <= list[i].kind(), part, attribute,
           "kinds in another order in element " + std::to_string(i),
           "meshes before grids before curves before points");
  }
}

void expect_materials(const std::vector<std::uint32_t>& materials, const Scene& scene,
                      const std::string& part, const std::string& attribute) {
  for (const std::uint32_t material : materials) {
    if (material != kNone) expect_index(material, scene.materials.size(), part, attribute);
  }
}

template <typename T, typename Shape>
void check_primvar(const Primvar<T>& primvar, const Shape& shape, const std::string& part,
                   const std::string& attribute) {
  if (!primvar.authored()) return;
  expect_segments(primvar.segments, part, attribute);
  const std::size_t count = value_count(primvar.interpolation, shape);
  const std::size_t keys = key_count(primvar.segments);
  expect(primvar.values.size() == keys * count, part, attribute,
         std::to_string(primvar.values.size()) + " values",
         std::to_string(keys) + " keys x " + std::to_string(count));
  expect_all_finite(primvar.values, part, attribute);
}

void expect_name(PrimvarName name, const Scene& scene, const std::string& part,
                 const std::string& attribute) {
  expect_index(name, scene.primvar_names.size(), part, attribute);
}

template <typename Named>
void expect_names_once(const std::vector<Named>& primvars, const std::string& part) {
  std::vector<PrimvarName> names;
  for (const Named& each : primvars) names.push_back(each.name);
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  expect(twice == names.end(), part, "primvars", "a name twice", "each once");
}

template <typename Shape>
void check_named_primvars(const Appearance& look, const Shape& shape, const Scene& scene,
                          const std::string& part) {
  for (const SurfacePrimvar& each : look.primvars) {
    expect_name(each.name, scene, part, "primvars");
    const std::string& name = scene.primvar_names[each.name];
    expect(each.primvar.authored(), part, name, "no values", "at least one");
    check_primvar(each.primvar, shape, part, name);
  }
  expect_names_once(look.primvars, part);
}

template <typename Shape>
void check_appearance(const Appearance& look, const Shape& shape, const Scene& scene,
                      const std::string& part) {
  check_primvar(look.display_color, shape, part, "displayColor");
  check_primvar(look.display_opacity, shape, part, "displayOpacity");
  check_named_primvars(look, shape, scene, part);
  if (look.material != kNone) expect_index(look.material, scene.materials.size(), part, "material");
}

void check_grids(const Grids& grids, const Scene& scene, const std::string& part) {
  validate(grids.shape);
  check_appearance(grids, grids.shape, scene, part);
  check_primvar(grids.normals, grids.shape, part, "normals");
  const auto expect_one_a_grid = [&](const std::vector<std::uint32_t>& values, const char* attribute) {
    expect(values.empty() || values.size() == grids.shape.grids.size(), part, attribute,
           std::to_string(values.size()) + " values", "none or " + std::to_string(grids.shape.grids.size()));
  };
  expect_one_a_grid(grids.grid_materials, "gridMaterials");
  expect_one_a_grid(grids.grid_faces, "gridFaces");
  expect_materials(grids.grid_materials, scene, part, "gridMaterials");
}

void check_curves(const Curves& curves, const Scene& scene, const std::string& part) {
  validate(curves.shape);
  check_appearance(curves, curves.shape, scene, part);
  expect(curves.span_curves.empty() || curves.span_curves.size() == curves.shape.spans.size(), part,
         "spanCurves", std::to_string(curves.span_curves.size()) + " values",
         "none or " + std::to_string(curves.shape.spans.size()));
}

void check_points(const Points& points, const Scene& scene, const std::string& part) {
  validate(points.shape);
  check_appearance(points, points.shape, scene, part);
}

void check_mesh(const Mesh& mesh, const Scene& scene, const std::string& part) {
  validate(mesh.shape);
  check_appearance(mesh, mesh.shape, scene, part);
  check_primvar(mesh.normals, mesh.shape, part, "normals");
  expect(mesh.triangle_materials.empty() || mesh.triangle_materials.size() == mesh.shape.triangles.size(),
         part, "triangleMaterials", std::to_string(mesh.triangle_materials.size()) + " values",
         "none or " + std::to_string(mesh.shape.triangles.size()));
  expect_materials(mesh.triangle_materials, scene, part, "triangleMaterials");
  expect(mesh.triangle_faces.empty() || mesh.triangle_faces.size() == mesh.shape.triangles.size(), part,
         "triangleFaces", std::to_string(mesh.triangle_faces.size()) + " values",
         "none or " + std::to_string(mesh.shape.triangles.size()));
}

void check_instances(const InstanceSet& set, const Scene& scene, const std::string& part) {
  expect_index(set.prototype, scene.prototypes.size(), part, "prototype");
  expect_segments(set.segments, part, "worldFromPrototype");
  expect(is_valid_form(set.form()), part, "worldFromPrototype", "degree " + std::to_string(set.degree),
         "1 to " + std::to_string(kMaxDegree) + ", and 1 for still instances");
  expect_time_remap(set.time_remap, part);
  const std::size_t controls = set.form().controls();
  expect(set.world_from_prototype.size() % controls == 0, part, "worldFromPrototype",
         std::to_string(set.world_from_prototype.size()) + " matrices",
         "a multiple of " + std::to_string(controls) + " controls");
  expect_all_finite(set.world_from_prototype, part, "worldFromPrototype");
  const std::size_t count = instance_count(set);
  expect_segments(set.color_segments, part, "displayColor");
  const std::size_t colors = count * key_count(set.color_segments);
  expect(set.display_color.empty() || set.display_color.size() == colors, part, "displayColor",
         std::to_string(set.display_color.size()) + " values", "none or " + std::to_string(colors));
  expect_all_finite(set.display_color, part, "displayColor");
  expect(set.display_opacity.empty() || set.display_opacity.size() == count, part, "displayOpacity",
         std::to_string(set.display_opacity.size()) + " values", "none or " + std::to_string(count));
  expect_all_finite(set.display_opacity, part, "displayOpacity");
  for (const InstancePrimvar& each : set.primvars) {
    expect_name(each.name, scene, part, "primvars");
    const std::string& name = scene.primvar_names[each.name];
    expect(each.values.size() == count, part, name, std::to_string(each.values.size()) + " values",
           std::to_string(count));
    expect_all_finite(each.values, part, name);
  }
  expect_names_once(set.primvars, part);
  expect(set.ids.empty() || set.ids.size() == count, part, "ids", std::to_string(set.ids.size()) + " values",
         "none or " + std::to_string(count));
  expect(set.materials.empty() || set.materials.size() == count, part, "materials",
         std::to_string(set.materials.size()) + " values", "none or " + std::to_string(count));
  expect(set.light_groups.empty() || set.light_groups.size() == count, part, "lightGroups",
         std::to_string(set.light_groups.size()) + " values", "none or " + std::to_string(count));
  expect_materials(set.materials, scene, part, "materials");
}

// How many light groups geometry names.
std::uint32_t light_group_count(const Scene& scene) {
  std::uint32_t count = 1;
  const auto grow = [&](const auto& looks) {
    for (const Appearance& look : looks) count = std::max(count, look.light_group + 1);
  };
  grow(scene.meshes);
  grow(scene.grids);
  grow(scene.curves);
  grow(scene.points);
  for (const InstanceSet& set : scene.instances) {
    for (const std::uint32_t group : set.light_groups) count = std::max(count, group + 1);
  }
  return count;
}

// That a mesh light names a place of a mesh.
void check_light_surface(const Light& light, const Scene& scene, const std::string& part) {
  if (light.kind != LightKind::kMesh) return;
  const LightSurface& surface = light.surface;
  expect(surface.mesh < scene.meshes.size(), part, "surface", "mesh " + std::to_string(surface.mesh),
         "one of " + std::to_string(scene.meshes.size()));
  expect(!scene.meshes[surface.mesh].shape.triangles.empty(), part, "surface", "a mesh without triangles",
         "one with triangles");
  const GeometryId mesh = mesh_id(surface.mesh);
  if (surface.set == LightSurface::kNoSet) {
    expect(std::ranges::find(scene.world, mesh) != scene.world.end(), part, "surface",
           "a mesh that is not in the world", "one that is");
    return;
  }
  expect(
      surface.set < scene.instances.size() && surface.instance < instance_count(scene.instances[surface.set]),
      part, "surface",
      "instance " + std::to_string(surface.instance) + " of set " + std::to_string(surface.set),
      "an instance of the scene's");
  const auto& geometry = scene.prototypes[scene.instances[surface.set].prototype].geometry;
  expect(std::ranges::find(geometry, mesh) != geometry.end(), part, "surface",
         "an instance that does not show the mesh", "one that does");
}

void check_window(const ScreenWindow& window, const std::string& part) {
  expect(window.left != window.right && window.bottom != window.top, part, "window",
         "an empty window (left " + std::to_string(window.left) + ", right " + std::to_string(window.right) +
             ", bottom " + std::to_string(window.bottom) + ", top " + std::to_string(window.top) + ")",
         "left and right, bottom and top to differ");
}

void check_lens(const Camera& camera, const std::string& part) {
  if (camera.lens.empty()) return;
  expect(camera.projection == Projection::kPerspective, part, "lens", "one on an orthographic camera",
         "none: its rays are parallel");
  expect_curve(camera.lens, camera.form(), part, "lens");
  for (const Lens& lens : camera.lens) {
    expect(lens.radius >= 0.0f, part, "lens radius", std::to_string(lens.radius), "a number of at least 0");
    expect(lens.focus_distance > 0.0f, part, "focusDistance", std::to_string(lens.focus_distance),
           "a distance above 0");
  }
}

void check_clip(const ClipRange& clip, Projection projection, const std::string& part) {
  const std::string range = std::to_string(clip.near_clip) + " to " + std::to_string(clip.far_clip);
  const float nearest = projection == Projection::kPerspective ? 0.0f : -std::numeric_limits<float>::max();
  expect(clip.near_clip >= nearest && clip.far_clip > clip.near_clip, part, "clippingRange", range,
         "near below far, and not negative for a perspective camera");
}

void check_planes(const Camera& camera, const std::string& part) {
  for (const ClippingPlane& plane : camera.clipping_planes) {
    expect(is_finite(plane.normal) && is_finite(plane.offset), part, "clippingPlanes",
           "a number that is not finite", "finite numbers");
  }
}

void check_camera(const Camera& camera) {
  const std::string part = camera.name.empty() ? "camera" : camera.name;
  expect_curve(camera.world_from_camera, camera.form(), part, "worldFromCamera");
  expect_curve(camera.window, camera.form(), part, "window");
  expect_time_remap(camera.time_remap, part);
  for (const ScreenWindow& window : camera.window) check_window(window, part);
  check_lens(camera, part);
  for (const Affine3f& m : camera.world_from_camera) {
    expect(m.determinant() != 0.0f, part, "worldFromCamera", "a singular matrix", "one that can be inverted");
  }
  check_planes(camera, part);
  check_clip({camera.near_clip, camera.far_clip}, camera.projection, part);
  if (camera.clip.empty()) return;
  expect_curve(camera.clip, camera.form(), part, "clippingRange");
  for (const ClipRange& clip : camera.clip) check_clip(clip, camera.projection, part);
}

}  // namespace

void validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    check_mesh(scene.meshes[i], scene, label(scene.meshes[i].shape.name, "mesh", i));
  }
  for (std::size_t i = 0; i < scene.grids.size(); ++i) {
    check_grids(scene.grids[i], scene, label(scene.grids[i].shape.name, "grids", i));
  }
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    check_curves(scene.curves[i], scene, label(scene.curves[i].shape.name, "curves", i));
  }
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    check_points(scene.points[i], scene, label(scene.points[i].shape.name, "points", i));
  }
  expect_geometry(scene.world, scene, "scene", "world");
  for (std::size_t i = 0; i < scene.prototypes.size(); ++i) {
    const Prototype& prototype = scene.prototypes[i];
    expect_time_remap(prototype.time_remap, label(prototype.name, "prototype", i));
    expect_geometry(prototype.geometry, scene, label(prototype.name, "prototype", i), "geometry");
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    check_instances(scene.instances[i], scene, label(scene.instances[i].name, "instances", i));
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    check_material(scene.materials[i], scene, label(scene.materials[i].name, "material", i));
  }
  check_primvar_names(scene);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    check_texture(scene.textures[i], label(scene.textures[i].name, "texture", i));
  }
  const std::uint32_t groups = light_group_count(scene);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    check_light(scene.lights[i], groups, label(scene.lights[i].name, "light", i));
    check_light_surface(scene.lights[i], scene, label(scene.lights[i].name, "light", i));
  }
  check_camera(scene.camera);
}

}  // namespace msbvh
