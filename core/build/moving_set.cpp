#include "core/build/moving_set.h"

#include <algorithm>
#include <array>

#include "core/build/clip.h"
#include "core/build/grid_clip.h"

namespace msbvh {
namespace {

// So many references tell how a set moves ...
constexpr std::size_t kSample = 64;
// ... which is incoherent where its area grows by this share from the centre to the shutter's mean, and where
// the octants of its box hold this share of the spread of its drifts. Of a motion that is linear in space,
// what turns or stretches as a whole, they hold a quarter: it grows, too, but sorting by position is enough
// for it.
constexpr float kIncoherentGrowth = 1.2f;
constexpr float kUnexplained = 0.5f;

// Sum of squared deviations from the mean.
class Spread {
 public:
  void add(__m128 x) {
    sum_ = _mm_add_ps(sum_, x);
    squares_ = _mm_add_ps(squares_, _mm_mul_ps(x, x));
    ++count_;
  }
  float squares() const {
    if (count_ == 0) return 0.0f;
    const __m128 mean = _mm_div_ps(sum_, _mm_set1_ps(static_cast<float>(count_)));
    alignas(16) float s[4];
    _mm_store_ps(s, _mm_sub_ps(squares_, _mm_mul_ps(sum_, mean)));
    return s[0] + s[1] + s[2];
  }

 private:
  __m128 sum_ = _mm_setzero_ps(), squares_ = _mm_setzero_ps();
  int count_ = 0;
};

Box3f box_at(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control) {
  const Vec3f* p = mesh.control_positions(control);
  Box4 box;
  for (const std::uint32_t v : triangle) box.grow(load4(p + v));
  return box.box();
}

Box3f fragment_at(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control,
                  const BarycentricPolygon& polygon) {
  const Vec3f* p = mesh.control_positions(control);
  const Vec3d v[3] = {Vec3d(p[triangle[0]]), Vec3d(p[triangle[1]]), Vec3d(p[triangle[2]])};
  Box3d box;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec3d& b = polygon.corners[i];
    box.grow(v[0] * b.x + v[1] * b.y + v[2] * b.z);
  }
  return {Vec3f(box.lo), Vec3f(box.hi)};
}

// A fragment's is that of the whole quads it lies in.
GridPatch window_of(const Primitives& primitives, const Reference& r) {
  return r.is_clipped() ? centre_patch(primitives, r).window(r.box)
                        : primitives.grids[r.grid_mesh()]->patches[r.index];
}

bool any_moves(const Primitives& primitives) {
  const auto moves = [](const auto& mesh) { return mesh->form().moving(); };
  return std::any_of(primitives.meshes.begin(), primitives.meshes.end(), moves) ||
         std::any_of(primitives.grids.begin(), primitives.grids.end(), moves) ||
         std::any_of(primitives.curves.begin(), primitives.curves.end(), moves) ||
         std::any_of(primitives.points.begin(), primitives.points.end(), moves) ||
         std::any_of(primitives.instances.begin(), primitives.instances.end(),
                     [](const InstanceBounds& b) { return b.form.moving(); });
}

}  // namespace

MeanArea::MeanArea(const Primitives& primitives) {
  const auto add = [this](const TrackForm& form) { one_segment_ &= form.controls() <= 2; };
  for (const auto& mesh : primitives.meshes) add(mesh->form());
  for (const auto& mesh : primitives.grids) add(mesh->form());
  for (const auto& set : primitives.curves) add(set->form());
  for (const auto& set : primitives.points) add(set->form());
  for (const InstanceBounds& b : primitives.instances) add(b.form);
}

ShutterPose::ShutterPose(const CentrePose& pose)
    : pose_(pose), mean_area_(pose.primitives()), moving_(any_moves(pose.primitives())) {}

MovingReference ShutterPose::at_ends(const Reference& r) const {
  const Primitives& primitives = pose_.primitives();
  if (r.is_instance()) {
    const InstanceBounds& b = primitives.instances[r.index];
    return {r, b.controls.front(), b.controls.back()};
  }
  if (!form_of(primitives, r).moving()) return {r, r.box, r.box};
  if (r.is_round()) {
    const std::uint32_t last = form_of(primitives, r).controls() - 1;
    return {r, round_box(primitives, r, 0), round_box(primitives, r, last)};
  }
  if (r.is_grid()) {
    const GridMesh& mesh = *primitives.grids[r.grid_mesh()];
    const GridPatch window = window_of(primitives, r);
    return {r, mesh.bounds(window, 0), mesh.bounds(window, mesh.form().controls() - 1)};
  }
  const TriangleMesh& mesh = *primitives.meshes[r.mesh()];
  const Triangle& triangle = mesh.triangles[r.index];
  const std::uint32_t last = mesh.form().controls() - 1;
  if (r.is_clipped()) {
    const BarycentricPolygon polygon = clip_to_box(pose_.triangle(r), r.box);
    if (polygon.count > 0)
      return {r, fragment_at(mesh, triangle, 0, polygon), fragment_at(mesh, triangle, last, polygon)};
  }
  return {r, box_at(mesh, triangle, 0), box_at(mesh, triangle, last)};
}

bool ShutterPose::incoherent(std::span<const Reference> references) const {
  std::array<ShutterBox, 2 * kSample> sample;
  std::size_t count = 0;
  MovingBounds bounds;
  const std::size_t stride = std::max<std::size_t>(1, references.size() / kSample);
  for (std::size_t i = 0; i < references.size(); i += stride) {
    sample[count] = ShutterBox(at_ends(references[i]));
    bounds.grow(sample[count++]);
  }
  if (mean_area_(bounds.box) <= kIncoherentGrowth * half_area(bounds.box.centre)) return false;
  const __m128 middle = _mm_mul_ps(bounds.positions.sum(), _mm_set1_ps(0.5f));
  Spread all;
  std::array<Spread, 8> octants;
  for (std::size_t i = 0; i < count; ++i) {
    all.add(sample[i].drift());
    octants[_mm_movemask_ps(_mm_cmplt_ps(sample[i].position(), middle)) & 7].add(sample[i].drift());
  }
  float within = 0.0f;
  for (const Spread& octant : octants) within += octant.squares();
  return within > kUnexplained * all.squares();
}

}  // namespace msbvh
