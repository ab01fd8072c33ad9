// Every builder, layout, number of keys and degree; what the next frame makes of a tree; instances. The tree
// holds its invariants and answers as the oracle does.
#include <memory>
#include <utility>
#include <vector>

#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "tests/fuzz/checks.h"
#include "tests/fuzz/fuzzed_shapes.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;

namespace {

BuildSettings fuzzed_settings(FuzzedData& data) {
  BuildSettings settings;
  settings.builder = data.one_of({Builder::kMsbvh, Builder::kMbvh, Builder::kSwept, Builder::kTimeSplit});
  settings.layout = data.one_of({TreeLayout::kFull, TreeLayout::kCompact});
  settings.spatial_split_budget = data.one_of({1.0f, 0.0f, 0.1f, 4.0f});
  settings.spatial_split_root_overlap = data.one_of({1e-5f, 0.0f});
  settings.spatial_split_node_overlap = data.one_of({0.3f, 0.0f});
  settings.rebraid_budget = data.one_of({8.0f, 0.0f, 1.0f});
  settings.sah_time = data.one_of({SahTime::kShutter, SahTime::kCentre});
  settings.time_slices = data.one_of({0u, 1u, 2u, 8u});
  settings.fewest_keys = data.coin();
  settings.max_leaf_triangles = data.one_of({8u, 1u, 4u, 32u});
  settings.refit = data.one_of({Refit::kAuto, Refit::kAlways, Refit::kNever});
  settings.keep_topology = data.coin();
  return settings;
}

struct Frame {
  std::vector<TriangleMesh> meshes;
  std::vector<GridMesh> grids;
  std::vector<CurveSet> curves;
  std::vector<PointSet> points;
};

template <typename Shape, typename Make>
void add_some(std::vector<Shape>& out, FuzzedData& data, std::uint32_t most, const std::vector<Shape>* before,
              const Make& make) {
  const std::size_t count = before ? before->size() : data.below(most + 1);
  for (std::size_t i = 0; i < count; ++i) out.push_back(make(data, before ? &(*before)[i] : nullptr));
}

Frame fuzzed_frame(FuzzedData& data, const Frame* before) {
  Frame frame;
  const auto kinds = before ? 15u : 1u + data.below(15);
  if (kinds & 1) add_some(frame.meshes, data, 2, before ? &before->meshes : nullptr, fuzzed_mesh);
  if (kinds & 2) add_some(frame.grids, data, 1, before ? &before->grids : nullptr, fuzzed_grids);
  if (kinds & 4) add_some(frame.curves, data, 1, before ? &before->curves : nullptr, fuzzed_curves);
  if (kinds & 8) add_some(frame.points, data, 1, before ? &before->points : nullptr, fuzzed_points);
  return frame;
}

void add(Accel& accel, const Frame& frame) {
  for (const TriangleMesh& mesh : frame.meshes) passes([&] { accel.add_mesh(mesh); });
  for (const GridMesh& grids : frame.grids) passes([&] { accel.add_grids(grids); });
  for (const CurveSet& curves : frame.curves) passes([&] { accel.add_curves(curves); });
  for (const PointSet& points : frame.points) passes([&] { accel.add_points(points); });
}

void add_instances(Accel& accel, FuzzedData& data, const std::shared_ptr<const Accel>& object) {
  const TrackForm form = fuzzed_form(data);
  const std::uint32_t count = fuzzed_count(data, form, 5);
  std::vector<Affine3f> maps;
  const std::uint32_t controls = is_valid_form(form) ? form.controls() : 2;
  const Affine3f first = data.map();
  for (std::uint32_t i = 0; i < count * controls; ++i) {
    maps.push_back(data.coin() ? first : data.map());
    maps.back().t = maps.back().t + Vec3f{float(i % 7), float(i % 3), 0.0f};
  }
  const TimeRemap remap = fuzzed_time_remap(data);
  if (!stays_in_reach(object->bvh(), maps)) return;
  passes([&] { accel.add_instances(object, form, maps, remap); });
}

// The object that is instanced, null where its tree is refused, and the world.
struct Trees {
  std::shared_ptr<Accel> object;
  Accel world;
};

bool committed(Accel& accel, Accel* before, const BuildSettings& settings) {
  return passes([&] { before ? accel.commit_from(*before, settings) : accel.commit(settings); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  const BuildSettings settings = fuzzed_settings(data);
  const bool instanced = data.coin();
  Frame object_shapes, world_shapes;
  Trees last;
  const std::uint32_t frames = 1 + data.below(3);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    Trees now;
    const bool same_shapes = frame > 0 && !data.rarely();
    if (instanced) {
      object_shapes = fuzzed_frame(data, same_shapes ? &object_shapes : nullptr);
      now.object = std::make_shared<Accel>();
      add(*now.object, object_shapes);
      const TimeRemap remap = fuzzed_time_remap(data);
      passes([&] { now.object->set_time_remap(remap); });
      if (!committed(*now.object, frame > 0 ? last.object.get() : nullptr, settings)) return 0;
      check_tree(*now.object, data, 2);
      add_instances(now.world, data, now.object);
    }
    world_shapes = fuzzed_frame(data, same_shapes ? &world_shapes : nullptr);
    add(now.world, world_shapes);
    if (!committed(now.world, frame > 0 ? &last.world : nullptr, settings)) return 0;
    check_tree(now.world, data, 6);
    last = std::move(now);
  }
  return 0;
}
