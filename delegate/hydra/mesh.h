// Meshes: polygons and subdivision surfaces.
#pragma once

#include <pxr/imaging/hd/mesh.h>

#include "delegate/hydra/shape.h"

namespace msbvh::hydra {

class RenderParam;

// The values of a mesh.
class MeshShape : public Shape {
 public:
  using Shape::Shape;

 protected:
  void sync_topology(HdSceneDelegate& delegate) override;
  bool topology_varies(HdSceneDelegate& delegate, const Shutter& shutter) const override;
  void describe(translate::MeshInput& mesh) const override;
  const HdGeomSubsets* subsets() const override { return &topology_.GetGeomSubsets(); }
  bool wants_normals() const override;

 private:
  HdMeshTopology topology_;
  PxOsdSubdivTags tags_;
  VtIntArray holes_;  // and faces that are invisible
};

class Mesh : public HdMesh {
 public:
  explicit Mesh(const SdfPath& path) : HdMesh(path), shape_(path) {}

  HdDirtyBits GetInitialDirtyBitsMask() const override { return kFirstBits; }
  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) override;
  void UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) override;
  void Finalize(HdRenderParam* param) override;

 protected:
  HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }
  void _InitRepr(const TfToken& name, HdDirtyBits* bits) override;

 private:
  MeshShape shape_;
};

}  // namespace msbvh::hydra
