#include "core/api/accel.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/bvh/build_bvh.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/bvh/verify.h"
#include "core/geometry/grid_mesh.h"
#include "core/trace/tracer.h"

namespace msbvh {
namespace {

void require_valid(const TimeRemap& time_remap) {
  if (is_valid_time_remap(time_remap)) return;
  throw Error(
      "accelerator: found a time remap whose pieces do not begin at 0 and increase, or whose local times "
      "decrease or leave [0, 1]");
}

}  // namespace

struct Accel::Data {
  // Until commit: a scene may hold an Accel for each of many small meshes.
  std::unique_ptr<BvhInput> input = std::make_unique<BvhInput>();
  std::shared_ptr<const Bvh> bvh;
  std::unique_ptr<KeptTopology> topology;  // for commit_from()
  std::optional<Tracer> tracer;

  void require_open() const {
    if (bvh) throw Error("accelerator: changed or committed after commit(); expected before");
  }
  // All or nothing: a tree that no kernel can trace is not committed.
  void close(BuiltBvh built) {
    auto tree = std::make_shared<const Bvh>(std::move(built.bvh));
    tracer.emplace(*tree);
    bvh = std::move(tree);
    topology = std::move(built.topology);
    input.reset();
  }
};

Accel::Accel() : data_(std::make_unique<Data>()) {}
Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;

Accel::Data& Accel::data() const {
  if (!data_) throw Error("accelerator: used after it was moved from; expected the one it was moved to");
  return *data_;
}

BvhInput& Accel::open() {
  data().require_open();
  return *data_->input;
}

const Accel::Data& Accel::committed() const {
  if (!data_ || !data_->tracer) [[unlikely]] {
    data();
    throw Error("accelerator: used before commit(); expected after one that succeeded");
  }
  return *data_;
}

std::uint32_t Accel::add_mesh(TriangleMesh mesh) {
  return add_mesh(std::make_shared<const TriangleMesh>(validated(std::move(mesh))));
}

std::uint32_t Accel::add_mesh(std::shared_ptr<const TriangleMesh> mesh) {
  if (!mesh) throw Error("accelerator: found no mesh behind the pointer; expected one");
  std::vector<std::shared_ptr<const TriangleMesh>>& meshes = open().meshes;
  meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(meshes.size() - 1);
}

std::uint32_t Accel::add_grids(GridMesh mesh) {
  open();
  validate(mesh);
  return add_grids(std::make_shared<const GridMesh>(std::move(mesh)));
}

std::uint32_t Accel::add_grids(std::shared_ptr<const GridMesh> mesh) {
  if (!mesh) throw Error("accelerator: found no grids behind the pointer; expected some");
  std::vector<std::shared_ptr<const GridMesh>>& grids = open().grids;
  grids.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(grids.size() - 1);
}

std::uint32_t Accel::add_curves(CurveSet curves) {
  open();
  validate(curves);
  return add_curves(std::make_shared<const CurveSet>(std::move(curves)));
}

std::uint32_t Accel::add_curves(std::shared_ptr<const CurveSet> curves) {
  if (!curves) throw Error("accelerator: found no curves behind the pointer; expected some");
  std::vector<std::shared_ptr<const CurveSet>>& sets = open().curves;
  sets.push_back(std::move(curves));
  return static_cast<std::uint32_t>(sets.size() - 1);
}

std::uint32_t Accel::add_points(PointSet points) {
  open();
  validate(points);
  return add_points(std::make_shared<const PointSet>(std::move(points)));
}

std::uint32_t Accel::add_points(std::shared_ptr<const PointSet> points) {
  if (!points) throw Error("accelerator: found no points behind the pointer; expected some");
  std::vector<std::shared_ptr<const PointSet>>& sets = open().points;
  sets.push_back(std::move(points));
  return static_cast<std::uint32_t>(sets.size() - 1);
}

std::uint32_t Accel::add_instances(std::shared_ptr<const Accel> object, const TrackForm& form,
                                   std::span<const Affine3f> world_from_object, const TimeRemap& time_remap) {
  BvhInput& in = open();
  if (!object || object->bvh().leaf_kinds.has(LeafKind::kInstances)) {
    throw Error("accelerator: an instance of an Accel that holds instances; expected one with meshes only");
  }
  if (!is_valid_form(form) || world_from_object.size() % form.controls() != 0) {
    throw Error("accelerator: " + std::to_string(world_from_object.size()) + " matrices for instances of " +
                std::to_string(form.segments) + " segments of degree " + std::to_string(form.degree) +
                "; expected a multiple of the number of controls");
  }
  require_valid(time_remap);
  if (!std::ranges::all_of(world_from_object, [](const Affine3f& m) { return is_finite(m); })) {
    throw Error("accelerator: an instance's matrix has an element that is not finite; expected finite ones");
  }
  const auto first = static_cast<std::uint32_t>(in.instances.size());
  std::uint64_t first_control = in.instance_controls.size();
  const std::size_t count = world_from_object.size() / form.controls();
  in.instance_controls.insert(in.instance_controls.end(), world_from_object.begin(), world_from_object.end());
  const auto time_remap_index =
      time_remap.is_shutter() ? kNoTimeRemap : static_cast<std::uint32_t>(in.time_remaps.size());
  if (time_remap_index != kNoTimeRemap) in.time_remaps.push_back(time_remap);
  for (std::size_t i = 0; i < count; ++i, first_control += form.controls()) {
    in.instances.push_back({object->data_->bvh, form, time_remap_index, first_control});
  }
  return first;
}

void Accel::set_time_remap(const TimeRemap& time_remap) {
  BvhInput& in = open();
  require_valid(time_remap);
  in.time_remap = time_remap;
}

void Accel::commit(const BuildSettings& settings) {
  const BvhInput& in = open();
  data_->close(build_bvh(in, settings));
}

void Accel::commit_from(Accel& previous, const BuildSettings& settings) {
  const BvhInput& in = open();
  const Bvh& last = previous.bvh();
  data_->close(next_bvh(in, settings, last, previous.data_->topology));
}

bool Accel::intersect(const Ray& ray, Hit& hit) const { return committed().tracer->intersect(ray, hit); }
bool Accel::occluded(const Ray& ray) const { return committed().tracer->occluded(ray); }
void Accel::intersect(std::span<const Ray> rays, Hit* hits) const {
  committed().tracer->intersect(rays, hits);
}
void Accel::occluded(std::span<const Ray> rays, bool* occluded) const {
  committed().tracer->occluded(rays, occluded);
}

const Bvh& Accel::bvh() const { return *committed().bvh; }
const BvhStatistics& Accel::statistics() const { return bvh().statistics; }
void Accel::verify() const { msbvh::verify(bvh()); }

}  // namespace msbvh
