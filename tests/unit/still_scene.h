// A triangle that calls for no effect, for tests of what does.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace msbvh {

inline Mesh triangle(const std::string& name, std::uint32_t segments) {
  Mesh mesh;
  mesh.shape.name = name;
  mesh.shape.segments = segments;
  mesh.shape.vertex_count = 3;
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    mesh.shape.positions.insert(mesh.shape.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  }
  mesh.shape.triangles = {{0, 1, 2}};
  return mesh;
}

inline Scene still_scene() {
  Scene scene;
  scene.camera.world_from_camera.resize(1);
  scene.camera.window.resize(1);
  scene.meshes = {triangle("/still", 0)};
  scene.world = {mesh_id(0)};
  return scene;
}

}  // namespace msbvh
