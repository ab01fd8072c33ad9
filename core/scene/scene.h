// The immutable snapshot of one frame that the renderer draws: plain data, no pointers into anyone else's.
//
// Space: "world" here is the frame's world, the stage's world minus the frame's origin (a point near the
// camera, kept in double by the front-end), so that single precision serves scenes at any distance from the
// stage's origin. Time: every track spans the open shutter, see core/motion/track.h. Colour: linear, in the
// working space (Rec.709 primaries); radiance without a photometric unit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/geometry_id.h"
#include "core/scene/camera.h"
#include "core/scene/curves.h"
#include "core/scene/grids.h"
#include "core/scene/instances.h"
#include "core/scene/light.h"
#include "core/scene/material.h"
#include "core/scene/mesh.h"
#include "core/scene/points.h"

namespace msbvh {

struct Scene {
  std::vector<Mesh> meshes;
  std::vector<Grids> grids;
  std::vector<Curves> curves;
  std::vector<Points> points;
  // What stands in the world directly: in one of the lists above, ordered by kind as GeometryKind is,
  // so that an id in a tree is a place in this list (core/shade/scene_index.h).
  std::vector<GeometryId> world;
  std::vector<Prototype> prototypes;
  std::vector<InstanceSet> instances;
  std::vector<Material> materials;
  std::vector<ImageTexture> textures;
  std::vector<std::string> primvar_names;  // that a PrimvarName stands for
  std::vector<Light> lights;
  Camera camera;

  const Mesh& mesh(GeometryId id) const { return meshes[id.index()]; }
  const Appearance* appearance(GeometryId id) const {
    switch (id.kind()) {
      case GeometryKind::kTriangleMesh:
        return &meshes[id.index()];
      case GeometryKind::kCurves:
        return &curves[id.index()];
      case GeometryKind::kPoints:
        return &points[id.index()];
      case GeometryKind::kGridMesh:
        return &grids[id.index()];
    }
    return nullptr;
  }
};

// The gate of the whole scene: the meshes (core/geometry's gate), primvar sizes, indices, track lengths,
// finite matrices, light and camera parameters. Changes nothing; throws Error naming the part, found and
// expected.
void validate(const Scene& scene);

}  // namespace msbvh
