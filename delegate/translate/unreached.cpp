#include "delegate/translate/unreached.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "core/base/box.h"
#include "core/base/parallel.h"
#include "core/plan/ray_reach.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/drawn_box.h"
#include "delegate/translate/view_volume.h"

namespace msbvh::translate {
namespace {

constexpr std::size_t kGrain = 1024;

bool is_hidden(const TimeRemap& time_remap) {
  return !time_remap.is_shutter() && std::ranges::none_of(time_remap.pieces, &TimeRemapPiece::visible);
}

Box3d box_of(const Scene& scene, GeometryId id) {
  switch (id.kind()) {
    case GeometryKind::kTriangleMesh:
      return drawn_box(scene.meshes[id.index()].shape);
    case GeometryKind::kGridMesh:
      return drawn_box(scene.grids[id.index()].shape);
    case GeometryKind::kCurves:
      return drawn_box(scene.curves[id.index()].shape.vertices);
    case GeometryKind::kPoints:
      return drawn_box(scene.points[id.index()].shape.vertices);
  }
  return {};
}

const std::string& name_of(const Scene& scene, GeometryId id) {
  switch (id.kind()) {
    case GeometryKind::kTriangleMesh:
      return scene.meshes[id.index()].shape.name;
    case GeometryKind::kGridMesh:
      return scene.grids[id.index()].shape.name;
    case GeometryKind::kCurves:
      return scene.curves[id.index()].shape.name;
    case GeometryKind::kPoints:
      break;
  }
  return scene.points[id.index()].shape.name;
}

// What is empty of the same name, and of the same number in AOVs.
template <typename Part>
void empty(Part& part) {
  Part nothing;
  nothing.shape.name = std::move(part.shape.name);
  nothing.prim_id = part.prim_id;
  if constexpr (requires { nothing.shape.positions; }) nothing.shape = validated(std::move(nothing.shape));
  if constexpr (requires { nothing.shape.grids; }) nothing.shape.values.resize(GridMesh::kGuard);
  part = std::move(nothing);
}

void empty(Scene& scene, GeometryId id) {
  switch (id.kind()) {
    case GeometryKind::kTriangleMesh:
      return empty(scene.meshes[id.index()]);
    case GeometryKind::kGridMesh:
      return empty(scene.grids[id.index()]);
    case GeometryKind::kCurves:
      return empty(scene.curves[id.index()]);
    case GeometryKind::kPoints:
      return empty(scene.points[id.index()]);
  }
}

// An instance is in the hull of the box under each control of its track.
bool misses(const ViewVolume& view, const Box3d& box, const InstanceSet& set) {
  if (box.empty()) return true;
  const BoxCorners corners = corners_of(box);
  const std::size_t controls = set.form().controls();
  std::atomic<bool> seen{false};
  parallel_for_ranges(instance_count(set), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !seen; ++i) {
      Box3d reached;
      for (std::size_t c = 0; c < controls; ++c)
        reached.grow(bounds_of(corners, Affine3d(set.world_from_prototype[i * controls + c])));
      if (!view.misses(reached)) seen = true;
    }
  });
  return !seen;
}

class Sweep {
 public:
  explicit Sweep(Scene& scene)
      : scene_(scene), places_(scene.instances.size()), left_(scene.prototypes.size()) {
    std::iota(places_.begin(), places_.end(), std::size_t{0});
  }

  template <typename Leaves>
  void instances(Unreached why, Leaves leaves) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      InstanceSet& set = scene_.instances[i];
      if (leaves(std::as_const(set))) {
        add({set.name, why, instance_count(set)}, set.prototype);
        found_.back().sets.push_back(places_[i]);
        left_[set.prototype] = true;
        continue;
      }
      places_[kept] = places_[i];
      if (kept != i) scene_.instances[kept] = std::move(set);
      ++kept;
    }
    scene_.instances.erase(scene_.instances.begin() + std::ptrdiff_t(kept), scene_.instances.end());
    places_.resize(kept);
  }

  void world(const ViewVolume& view) {
    std::erase_if(scene_.world, [&](GeometryId id) {
      if (!view.misses(box_of(scene_, id))) return false;
      add({name_of(scene_, id), Unreached::kOutsidePicture}, kNone);
      found_.back().world.push_back(id);
      empty(scene_, id);
      return true;
    });
  }

  // Those that nothing places any more.
  void prototypes() {
    for (const InstanceSet& set : scene_.instances) left_[set.prototype] = false;
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (!left_[i]) continue;
      for (const GeometryId id : scene_.prototypes[i].geometry) empty(scene_, id);
      scene_.prototypes[i].geometry.clear();
    }
  }

  std::vector<LeftOut> found() && { return std::move(found_); }

 private:
  // A prim's sets stand next to each other; those of its prototype's other parts place the same instances
  // again.
  void add(LeftOut one, std::uint32_t prototype) {
    const bool again = !found_.empty() && found_.back().path == one.path && found_.back().why == one.why;
    if (!again) {
      found_.push_back(std::move(one));
      prototype_ = prototype;
    } else if (prototype == prototype_) {
      found_.back().count += one.count;
    }
  }

  Scene& scene_;
  std::vector<std::size_t> places_;  // of the instances that are left, before any left
  std::uint32_t prototype_ = kNone;  // of the last one found
  std::vector<bool> left_;           // by prototype: whether sets of it have left
  std::vector<LeftOut> found_;
};

}  // namespace

std::vector<LeftOut> leave_out_unreached(Scene& scene, std::uint32_t width, std::uint32_t height,
                                         std::optional<std::uint32_t> max_bounces) {
  Sweep sweep(scene);
  sweep.instances(Unreached::kHidden, [](const InstanceSet& set) { return is_hidden(set.time_remap); });
  if (max_bounces && !goes_beyond_camera_rays(scene, *max_bounces)) {
    const ViewVolume view(scene.camera, width, height);
    std::vector<Box3d> boxes(scene.prototypes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (const GeometryId id : scene.prototypes[i].geometry) boxes[i].grow(box_of(scene, id));
    }
    sweep.world(view);
    sweep.instances(Unreached::kOutsidePicture,
                    [&](const InstanceSet& set) { return misses(view, boxes[set.prototype], set); });
  }
  sweep.prototypes();
  return std::move(sweep).found();
}

}  // namespace msbvh::translate
