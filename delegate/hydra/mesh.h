// Meshes: polygons and subdivision surfaces.
#pragma once

#include <pxr/imaging/hd/mesh.h>

#include "delegate/hydra/drawn.h"

namespace msbvh::hydra {

// The values of a mesh.
class MeshShape : public Shape {
 public:
  using Shape::Shape;

 protected:
  void sync_topology(HdSceneDelegate& delegate) override;
  bool pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) override;
  void describe(translate::FrameShape& shape) const override;
  bool wants_normals() const override;

 private:
  void pull_held(HdSceneDelegate& delegate, const Shutter& shutter);
  void describe_subdivision(translate::MeshInput& mesh) const;

  HdMeshTopology topology_;
  PxOsdSubdivTags tags_;
  VtIntArray holes_;              // and faces that are invisible
  TimedInts held_holes_;          // over the shutter, likewise
  std::vector<TimedInts> parts_;  // of each subset, its faces over the shutter
};

using Mesh = Drawn<HdMesh, MeshShape>;

}  // namespace msbvh::hydra
