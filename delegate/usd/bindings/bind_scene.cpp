// What is in a finished scene, for tests and reports: counts, and where its vertices are at any time.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "core/motion/affine_track.h"
#include "core/scene/scene.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using Points = nb::ndarray<nb::numpy, double, nb::ndim<3>>;

nb::dict statistics(const SceneHandle& handle) {
  const Scene& scene = *handle.scene;
  std::size_t triangles = 0, keys = 0, instances = 0;
  for (const Mesh& mesh : scene.meshes) {
    triangles += mesh.shape.triangles.size();
    keys += mesh.shape.form().controls();
  }
  for (const Grids& grids : scene.grids) {
    triangles += grids.shape.triangle_count();
    keys += grids.shape.form().controls();
  }
  std::size_t spans = 0, points = 0;
  for (const Curves& curves : scene.curves) {
    spans += curves.shape.span_count();
    keys += curves.shape.form().controls();
  }
  for (const msbvh::Points& set : scene.points) {
    points += set.shape.point_count;
    keys += set.shape.form().controls();
  }
  for (const InstanceSet& set : scene.instances) {
    instances += instance_count(set);
    keys += set.world_from_prototype.size();
  }
  nb::dict result;
  result["meshes"] = scene.meshes.size() + scene.grids.size();
  result["triangles"] = triangles;
  result["spans"] = spans;
  result["points"] = points;
  result["keys"] = keys;
  result["instances"] = instances;
  result["lights"] = scene.lights.size();
  return result;
}

struct Posed {
  std::string name;
  std::vector<Vec3d> vertices;  // in the geometry's own space
};

// Of a mesh its vertices, of grids their points, of curves their Bezier vertices.
Posed posed(const Scene& scene, GeometryId id, float time) {
  Posed result;
  if (id.is(GeometryKind::kGridMesh)) {
    const GridMesh& shape = scene.grids[id.index()].shape;
    result.name = shape.name;
    for (const Grid& grid : shape.grids) {
      for (std::uint32_t r = 0; r <= grid.rows; ++r) {
        for (std::uint32_t c = 0; c <= grid.columns; ++c)
          result.vertices.push_back(Vec3d(shape.point(grid, r, c, time)));
      }
    }
    return result;
  }
  const auto add_round = [&](const auto& shape, std::uint32_t count) {
    result.name = shape.name;
    for (std::uint32_t v = 0; v < count; ++v) result.vertices.push_back(Vec3d(shape.vertex(v, time).p));
    return result;
  };
  if (id.is(GeometryKind::kCurves)) {
    const CurveSet& shape = scene.curves[id.index()].shape;
    return add_round(shape, shape.vertex_count);
  }
  if (id.is(GeometryKind::kPoints)) {
    const PointSet& shape = scene.points[id.index()].shape;
    return add_round(shape, shape.point_count);
  }
  const TriangleMesh& shape = scene.mesh(id).shape;
  result.name = shape.name;
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    result.vertices.push_back(Vec3d(shape.position(v, time)));
  return result;
}

// [maps][vertices][3], in stage space.
Points placed(const std::vector<Vec3d>& local, std::span<const Affine3f> maps, const Vec3d& origin) {
  auto* data = new std::vector<Vec3d>();
  data->reserve(local.size() * maps.size());
  for (const Affine3f& map : maps) {
    for (const Vec3d& p : local) data->push_back(Affine3d(map).point(p) + origin);
  }
  const nb::capsule owner(data, [](void* p) noexcept { delete static_cast<std::vector<Vec3d>*>(p); });
  return Points(data->data(), {maps.size(), local.size(), 3}, owner);
}

std::vector<Affine3f> maps_at(const InstanceSet& set, float time) {
  const std::uint32_t controls = set.form().controls();
  std::vector<Affine3f> maps;
  for (std::size_t i = 0; i < instance_count(set); ++i) {
    maps.push_back(evaluate({set.world_from_prototype.data() + i * controls, controls}, set.form(), time));
  }
  return maps;
}

// As the tracer sees them: float tracks under their time remaps. What is hidden at that time is left out.
std::vector<nb::tuple> poses(const SceneHandle& handle, float time) {
  const Scene& scene = *handle.scene;
  const Affine3f identity;
  std::vector<nb::tuple> result;
  for (const GeometryId index : scene.world) {
    const Posed shape = posed(scene, index, time);
    result.push_back(
        nb::make_tuple(shape.name, shape.name, placed(shape.vertices, {&identity, 1}, handle.origin)));
  }
  for (const InstanceSet& set : scene.instances) {
    const Prototype& prototype = scene.prototypes[set.prototype];
    float own = time, inside = time;
    if (!set.time_remap.at(time, own) || !prototype.time_remap.at(time, inside)) continue;
    const std::vector<Affine3f> maps = maps_at(set, own);
    for (const GeometryId index : prototype.geometry) {
      const Posed shape = posed(scene, index, inside);
      result.push_back(nb::make_tuple(shape.name, set.name, placed(shape.vertices, maps, handle.origin)));
    }
  }
  return result;
}

// (world_from_camera in stage space, row vectors; window left, right, bottom, top; lens radius and focus
// distance; clipping range) from the tracks as the renderer reads them.
nb::tuple camera_at(const SceneHandle& handle, float time) {
  const Camera& camera = handle.scene->camera;
  float local = time;
  camera.time_remap.at(time, local);
  const SegmentTime at = locate(local, camera.segments);
  const auto value = [&](const auto& controls) {
    return track_value(controls.data(), camera.form(), at.key, at.w);
  };
  const Affine3d map(value(camera.world_from_camera));
  const ScreenWindow window = value(camera.window);
  const Lens lens = camera.lens.empty() ? Lens{} : value(camera.lens);
  const ClipRange clip =
      camera.clip.empty() ? ClipRange{camera.near_clip, camera.far_clip} : value(camera.clip);
  std::vector<std::vector<double>> rows;
  for (const Vec3d& v : {map.x, map.y, map.z}) rows.push_back({v.x, v.y, v.z, 0.0});
  const Vec3d t = map.t + handle.origin;
  rows.push_back({t.x, t.y, t.z, 1.0});
  return nb::make_tuple(rows, nb::make_tuple(window.left, window.right, window.bottom, window.top),
                        nb::make_tuple(lens.radius, lens.focus_distance),
                        nb::make_tuple(clip.near_clip, clip.far_clip));
}

std::vector<std::string> mesh_names(const SceneHandle& handle) {
  std::vector<std::string> names;
  for (const Mesh& mesh : handle.scene->meshes) names.push_back(mesh.shape.name);
  for (const Grids& grids : handle.scene->grids) names.push_back(grids.shape.name);
  for (const Curves& curves : handle.scene->curves) names.push_back(curves.shape.name);
  for (const msbvh::Points& points : handle.scene->points) names.push_back(points.shape.name);
  return names;
}

}  // namespace

void bind_scene(nb::module_& m) {
  nb::class_<SceneHandle> scene(m, "Scene");
  scene.def("statistics", &statistics)
      .def_prop_ro("mesh_names", &mesh_names)
      .def("poses", &poses, nb::arg("time01"))
      .def("camera", &camera_at, nb::arg("time01"));
  bind_scene_look(scene);
}

}  // namespace msbvh::python
