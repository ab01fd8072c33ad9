#include "delegate/hydra/mesh.h"

#include <algorithm>
#include <pxr/imaging/hd/meshSchema.h>
#include <pxr/imaging/hd/meshTopologySchema.h>
#include <pxr/imaging/pxOsd/tokens.h>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/sync_shape.h"

namespace msbvh::hydra {
namespace {

// Integers are held until the next sample: the one after the shutter says nothing.
bool changes(const HdIntArrayDataSourceHandle& source, const Shutter& shutter) {
  if (!source) return false;
  const std::vector<float> offsets = contributing_offsets(*source, shutter);
  if (offsets.empty()) return false;
  const VtIntArray first = source->GetTypedValue(offsets.front());
  return std::any_of(offsets.begin(), offsets.end(), [&](float offset) {
    return double(offset) <= shutter.close_frames && source->GetTypedValue(offset) != first;
  });
}

void set_if_given(std::string& rule, const TfToken& token) {
  if (!token.IsEmpty()) rule = token.GetString();
}

}  // namespace

void MeshShape::sync_topology(HdSceneDelegate& delegate) {
  topology_ = delegate.GetMeshTopology(path());
  tags_ = delegate.GetSubdivTags(path());
  holes_ = topology_.GetHoleIndices();
  for (const int face : topology_.GetInvisibleFaces()) holes_.push_back(face);
}

bool MeshShape::topology_varies(HdSceneDelegate& delegate, const Shutter& shutter) const {
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path());
  if (!prim) return false;
  HdMeshTopologySchema topology = HdMeshSchema::GetFromParent(prim).GetTopology();
  if (!topology) return false;
  return changes(topology.GetFaceVertexCounts(), shutter) ||
         changes(topology.GetFaceVertexIndices(), shutter);
}

bool MeshShape::wants_normals() const { return topology_.GetScheme() == PxOsdOpenSubdivTokens->none; }

void MeshShape::describe(translate::MeshInput& mesh) const {
  mesh.face_vertex_counts = span_of(topology_.GetFaceVertexCounts());
  mesh.face_vertex_indices = span_of(topology_.GetFaceVertexIndices());
  mesh.hole_indices = span_of(holes_);
  mesh.left_handed = topology_.GetOrientation() == PxOsdOpenSubdivTokens->leftHanded;
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

void Mesh::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits, const TfToken&) {
  sync_shape(*this, shape_, *delegate, *static_cast<RenderParam*>(param), *bits,
             [&] { _UpdateInstancer(delegate, bits); });
}

// Hydra looks tags up outside of Sync, and may sync nothing then.
void Mesh::UpdateRenderTag(HdSceneDelegate* delegate, HdRenderParam* param) {
  HdMesh::UpdateRenderTag(delegate, param);
  shape_.set_render_tag(GetRenderTag(), *static_cast<RenderParam*>(param));
}

void Mesh::Finalize(HdRenderParam* param) { static_cast<RenderParam*>(param)->forget_shape(shape_); }

void Mesh::_InitRepr(const TfToken& name, HdDirtyBits*) {
  if (std::none_of(_reprs.begin(), _reprs.end(), _ReprComparator(name)))
    _reprs.emplace_back(name, HdReprSharedPtr());
}

}  // namespace msbvh::hydra
