#include "delegate/hydra/mesh.h"

#include <algorithm>
#include <pxr/imaging/hd/geomSubsetSchema.h>
#include <pxr/imaging/hd/meshSchema.h>
#include <pxr/imaging/hd/meshTopologySchema.h>
#include <pxr/imaging/pxOsd/tokens.h>

namespace msbvh::hydra {
namespace {

void append(VtIntArray& faces, const VtIntArray& more) {
  for (const int face : more) faces.push_back(face);
}

void set_if_given(std::string& rule, const TfToken& token) {
  if (!token.IsEmpty()) rule = token.GetString();
}

}  // namespace

void MeshShape::sync_topology(HdSceneDelegate& delegate) {
  topology_ = delegate.GetMeshTopology(path());
  tags_ = delegate.GetSubdivTags(path());
  holes_ = topology_.GetHoleIndices();
  append(holes_, topology_.GetInvisibleFaces());
}

bool MeshShape::pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) {
  held_holes_.clear();
  parts_.assign(topology_.GetGeomSubsets().size(), {});
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path());
  if (!prim || !shutter.moving()) return false;
  pull_held(delegate, shutter);
  HdMeshTopologySchema topology = HdMeshSchema::GetFromParent(prim).GetTopology();
  if (!topology) return false;
  held_holes_ = timed_ints(topology.GetHoleIndices(), shutter);
  for (auto& [time01, faces] : held_holes_) append(faces, topology_.GetInvisibleFaces());
  return changes_within(topology.GetFaceVertexCounts(), shutter) ||
         changes_within(topology.GetFaceVertexIndices(), shutter);
}

// A subset is a prim of its own.
void MeshShape::pull_held(HdSceneDelegate& delegate, const Shutter& shutter) {
  const HdGeomSubsets& subsets = topology_.GetGeomSubsets();
  for (std::size_t i = 0; i < subsets.size(); ++i) {
    const HdContainerDataSourceHandle prim = scene_index_prim(delegate, subsets[i].id);
    if (prim) parts_[i] = timed_ints(HdGeomSubsetSchema::GetFromParent(prim).GetIndices(), shutter);
  }
}

bool MeshShape::wants_normals() const { return topology_.GetScheme() == PxOsdOpenSubdivTokens->none; }

void MeshShape::describe(translate::FrameShape& shape) const {
  translate::MeshInput& mesh = shape.mesh;
  mesh.face_vertex_counts = span_of(topology_.GetFaceVertexCounts());
  mesh.face_vertex_indices = span_of(topology_.GetFaceVertexIndices());
  mesh.hole_indices = span_of(holes_);
  shape.held.holes = held_indices(held_holes_);
  mesh.left_handed = topology_.GetOrientation() == PxOsdOpenSubdivTokens->leftHanded;
  describe_subdivision(mesh);
  const HdGeomSubsets& subsets = topology_.GetGeomSubsets();
  for (std::size_t i = 0; i < subsets.size(); ++i) {
    const HdGeomSubset& part = subsets[i];
    if (part.type != HdGeomSubset::TypeFaceSet || part.materialId.IsEmpty()) continue;
    const translate::HeldIndices held =
        i < parts_.size() ? held_indices(parts_[i]) : translate::HeldIndices();
    shape.subsets.push_back(
        {{part.id.GetString(), span_of(part.indices)}, part.materialId.GetString(), held});
  }
}

void MeshShape::describe_subdivision(translate::MeshInput& mesh) const {
  translate::SubdivisionInput& rules = mesh.subdivision;
  set_if_given(rules.scheme, topology_.GetScheme());
  mesh.computed_normals = rules.scheme == "none" ? translate::Normals::kFaceted : translate::Normals::kSmooth;
  if (rules.scheme == "none") return;
  set_if_given(rules.interpolate_boundary, tags_.GetVertexInterpolationRule());
  set_if_given(rules.face_varying_linear, tags_.GetFaceVaryingInterpolationRule());
  set_if_given(rules.triangle_rule, tags_.GetTriangleSubdivision());
  rules.crease_lengths = span_of(tags_.GetCreaseLengths());
  rules.crease_indices = span_of(tags_.GetCreaseIndices());
  rules.crease_sharpnesses = span_of(tags_.GetCreaseWeights());
  rules.corner_indices = span_of(tags_.GetCornerIndices());
  rules.corner_sharpnesses = span_of(tags_.GetCornerWeights());
}

}  // namespace msbvh::hydra
