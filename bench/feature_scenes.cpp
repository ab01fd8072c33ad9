#include "bench/feature_scenes.h"

#include <algorithm>
#include <utility>

#include "bench/peer_input.h"
#include "core/base/error.h"

namespace msbvh::bench {
namespace {

// As in run_scene.cpp, so that a curve is compared with what a peer would need.
constexpr double kTolerance = 0.1 / 960.0;

void add_world_mesh(Scene& scene, TriangleMesh shape) {
  scene.world.push_back(mesh_id(static_cast<std::uint32_t>(scene.meshes.size())));
  scene.meshes.emplace_back().shape = validated(std::move(shape));
}

double diagonal(const Scene& scene) {
  Box3f box;
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t p = 0; p < mesh.shape.position_count(); ++p) box.grow(mesh.shape.positions[p]);
  }
  return length(Vec3d(box.extent()));
}

// M(u) p(u) with both linear on each segment, as a quadratic on it.
TriangleMesh placed(const TriangleMesh& mesh, const Affine3f* world_from_object) {
  TriangleMesh out;
  out.name = mesh.name;
  out.segments = mesh.segments;
  out.degree = 2;
  out.vertex_count = mesh.vertex_count;
  out.triangles = mesh.triangles;
  out.positions.reserve(out.position_count() + TriangleMesh::kGuard);
  const auto add = [&](const auto& position) {
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) out.positions.push_back(position(v));
  };
  const auto at = [&](std::uint32_t map, std::uint32_t key, std::uint32_t v) {
    return world_from_object[map].point(mesh.control_positions(key)[v]);
  };
  add([&](std::uint32_t v) { return at(0, 0, v); });
  for (std::uint32_t k = 0; k < mesh.segments; ++k) {
    add([&](std::uint32_t v) { return (at(k, k + 1, v) + at(k + 1, k, v)) * 0.5f; });
    add([&](std::uint32_t v) { return at(k + 1, k + 1, v); });
  }
  return out;
}

}  // namespace

std::string form_text(const TrackForm& form) {
  if (form.degree == 1) return std::to_string(key_count(form.segments)) + (form.moving() ? " keys" : " key");
  return std::to_string(form.segments) + (form.degree == 2 ? " quadratic" : " cubic") + " segment" +
         (form.segments > 1 ? "s" : "");
}

TrackForm finest_form(const Scene& scene) {
  TrackForm form;
  for (const Mesh& mesh : scene.meshes) form = common_form(form, mesh.shape.form());
  for (const Curves& curves : scene.curves) form = common_form(form, curves.shape.form());
  for (const Points& points : scene.points) form = common_form(form, points.shape.form());
  return form;
}

ScenePtr with_linear_keys(const ScenePtr& scene) {
  PeerInput input;
  fill_peer_input(*scene, kTolerance * diagonal(*scene), input);
  auto out = std::make_shared<Scene>();
  out->camera = scene->camera;
  for (std::size_t i = 0; i < input.scene.world.meshes.size(); ++i) {
    const PeerMesh& keys = input.scene.world.meshes[i];
    TriangleMesh shape = scene->mesh(scene->world[i]).shape;
    shape.segments = keys.keys - 1;
    shape.degree = 1;
    shape.positions.assign(keys.positions, keys.positions + shape.position_count());
    add_world_mesh(*out, std::move(shape));
  }
  return out;
}

ScenePtr flattened(const Scene& scene) {
  auto out = std::make_shared<Scene>();
  out->camera = scene.camera;
  for (const InstanceSet& set : scene.instances) {
    const TriangleMesh& mesh = scene.mesh(scene.prototypes[set.prototype].geometry.at(0)).shape;
    if (mesh.form() != set.form() || mesh.degree != 1 || !mesh.form().moving())
      throw Error("bench: found tracks of two forms in " + set.name + "; expected linear ones of one form");
    for (std::size_t i = 0; i < instance_count(set); ++i)
      add_world_mesh(*out, placed(mesh, &set.world_from_prototype[i * set.form().controls()]));
  }
  return out;
}

ScenePtr next_frame(const Scene& scene) {
  auto out = std::make_shared<Scene>(scene);
  for (Mesh& mesh : out->meshes) {
    TriangleMesh& shape = mesh.shape;
    const std::vector<Vec3f> before = shape.positions;
    const std::size_t last = std::size_t(shape.form().controls() - 1) * shape.vertex_count;
    for (std::size_t p = 0; p < shape.position_count(); ++p) {
      const std::size_t vertex = p % shape.vertex_count;
      shape.positions[p] = before[p] + (before[last + vertex] - before[vertex]);
    }
  }
  return out;
}

}  // namespace msbvh::bench
