// A scene that passes the gate, for tests of what does not.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/scene/scene.h"

namespace msbvh {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

inline Scene valid_scene() {
  Scene scene;
  Mesh mesh;
  mesh.shape.name = "/mesh";
  mesh.shape.vertex_count = 4;
  mesh.shape.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.shape = validated(std::move(mesh.shape));
  scene.meshes = {mesh};
  scene.world = {mesh_id(0)};
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, 1, std::vector<Affine3f>(6), {}}};
  scene.materials.resize(1);
  scene.materials[0].name = "/material";
  scene.lights.resize(1);
  scene.lights[0].name = "/light";
  scene.lights[0].world_from_light.resize(1);
  scene.camera.name = "/camera";
  scene.camera.world_from_camera.resize(1);
  scene.camera.window.resize(1);
  return scene;
}

inline Curves valid_curves() {
  Curves curves;
  curves.shape.name = "/curves";
  curves.shape.vertex_count = 7;
  curves.shape.vertices.resize(7, {{1, 2, 3}, 0.5f});
  curves.shape.spans = {0, 3};
  return curves;
}

// What validate() says; empty: nothing.
inline std::string complaint(const Scene& scene) {
  try {
    validate(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace msbvh
