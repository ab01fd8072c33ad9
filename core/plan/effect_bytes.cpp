#include "core/plan/effect_bytes.h"

#include <bit>
#include <numeric>

namespace msbvh {
namespace {

std::size_t index_of(Effect effect) {
  return std::size_t(std::countr_zero(static_cast<std::uint32_t>(effect)));
}

// A track's bytes, of `control_bytes` at each control.
void add_track(const TrackForm& form, std::uint64_t control_bytes, std::uint64_t& first_key, Effect mover,
               EffectBytes& bytes) {
  first_key += control_bytes;
  bytes[mover] += form.segments * control_bytes;
  bytes[Effect::kPolynomialMotion] += std::uint64_t(form.segments) * (form.degree - 1) * control_bytes;
}

void add_mesh(const Mesh& mesh, EffectBytes& bytes) {
  std::uint64_t& shape = mesh.displaced_by > 0.0f ? bytes[Effect::kDisplacement]
                         : mesh.cage_faces > 0    ? bytes[Effect::kSubdivision]
                                                  : bytes.base;
  add_track(mesh.shape.form(), mesh.shape.vertex_count * sizeof(Vec3f), shape, Effect::kDeformingKeys, bytes);
  shape += mesh.shape.triangles.size() * sizeof(Triangle);
}

// Grids come of displacement alone.
void add_grids(const GridMesh& shape, EffectBytes& bytes) {
  std::uint64_t points = 0;
  for (const Grid& grid : shape.grids) points += grid.points();
  std::uint64_t& displaced = bytes[Effect::kDisplacement];
  add_track(shape.form(), points * sizeof(Vec3f), displaced, Effect::kDeformingKeys, bytes);
  displaced += shape.grids.size() * sizeof(Grid) + shape.patches.size() * sizeof(GridPatch);
}

void add_instances(const InstanceSet& set, EffectBytes& bytes) {
  add_track(set.form(), instance_count(set) * sizeof(Affine3f), bytes[Effect::kInstances],
            Effect::kMovingInstances, bytes);
  bytes[Effect::kTimeRemaps] += set.time_remap.pieces.size() * sizeof(TimeRemapPiece);
}

void add_light(const Light& light, EffectBytes& bytes) {
  if (!light.image) return;
  bytes[is_image_dome(light) ? Effect::kImageDome : Effect::kLightControls] +=
      light.image->texels.size() * (sizeof(Vec3f) + sizeof(float)) + light.image->height * sizeof(float);
}

}  // namespace

std::uint64_t& EffectBytes::operator[](Effect effect) { return of_effect[index_of(effect)]; }
std::uint64_t EffectBytes::operator[](Effect effect) const { return of_effect[index_of(effect)]; }
std::uint64_t EffectBytes::total() const { return std::accumulate(of_effect.begin(), of_effect.end(), base); }

EffectBytes effect_bytes(const Scene& scene) {
  EffectBytes bytes;
  for (const Mesh& mesh : scene.meshes) add_mesh(mesh, bytes);
  for (const Grids& grids : scene.grids) add_grids(grids.shape, bytes);
  for (const Curves& curves : scene.curves) {
    const CurveSet& shape = curves.shape;
    std::uint64_t& first_key = bytes[Effect::kCurves];
    add_track(shape.form(), shape.vertex_count * sizeof(RoundVertex), first_key, Effect::kDeformingKeys,
              bytes);
    first_key += shape.spans.size() * sizeof(std::uint32_t);
  }
  for (const Points& points : scene.points) {
    const PointSet& shape = points.shape;
    add_track(shape.form(), shape.point_count * sizeof(RoundVertex), bytes[Effect::kPoints],
              Effect::kDeformingKeys, bytes);
  }
  for (const Prototype& prototype : scene.prototypes) {
    bytes[Effect::kTimeRemaps] += prototype.time_remap.pieces.size() * sizeof(TimeRemapPiece);
  }
  for (const InstanceSet& set : scene.instances) add_instances(set, bytes);
  for (const Light& light : scene.lights) add_light(light, bytes);
  return bytes;
}

}  // namespace msbvh
