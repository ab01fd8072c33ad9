#include "bench/stability.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bench/json_row.h"
#include "bench/peer_input.h"
#include "bench/trees.h"
#include "core/base/parallel.h"
#include "core/probe/closed_mesh.h"
#include "core/probe/inside_rays.h"
#include "core/probe/round_rays.h"
#include "core/probe/tracer_under_test.h"
#include "core/trace/oracle.h"

namespace msbvh::bench {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kRaysOfStart = 60;  // ten of each aim
constexpr std::size_t kPlainRays = 10;    // times those of other rows: one aim has the room of six
constexpr std::size_t kSingle = 0;        // of either side's ways

class PeerUnderTest : public TracerUnderTest {
 public:
  PeerUnderTest(const PeerLibrary& library, const PeerScene& scene)
      : library_(library), peer_(library.make(scene, 0, true)) {
    peer_->build();
  }
  const std::vector<std::string>& ways() const override { return library_.modes(); }
  void closest(std::size_t way, std::span<const Ray> rays, float* t) const override {
    const auto prepared = peer_->prepare(rays.data(), rays.size());
    peer_->intersect(way, *prepared, 0, rays.size(), t);
  }

 private:
  const PeerLibrary& library_;
  const std::unique_ptr<Peer> peer_;
};

const char* probe_name(StabilityProbe probe) {
  constexpr const char* kNames[] = {"from inside", "from inside, plain", "into round"};
  return kNames[static_cast<std::size_t>(probe)];
}

using OfAims = std::array<std::size_t, std::size(kInsideAims)>;

struct Found {
  std::size_t leaks = 0;
  OfAims of_aims{};
  std::size_t at_keys = 0;
  std::optional<std::size_t> wrong{};  // none: not judged
};

// Half of the times are: core/probe/probe_random.h.
bool is_at_key(const Ray& ray) {
  const double key = double(ray.time) * kMaxSegments;
  return std::abs(key - std::round(key)) < 1e-4;
}

// Those of the worst way stay.
void count_leaks(const TracerUnderTest& tracer, const InsideRays& inside, Found& found) {
  for (std::size_t way = 0; way < tracer.ways().size(); ++way) {
    const std::vector<std::size_t> lost = lost_rays(tracer, way, inside.rays);
    if (lost.size() <= found.leaks) continue;
    found.leaks = lost.size();
    found.of_aims = {};
    found.at_keys = 0;
    for (const std::size_t i : lost) {
      ++found.of_aims[static_cast<std::size_t>(inside.aims[i])];
      found.at_keys += is_at_key(inside.rays[i]);
    }
  }
}

std::size_t count_wrong(const TracerUnderTest& tracer, const Bvh& world, std::span<const Ray> rays,
                        std::size_t judged) {
  std::atomic<std::size_t> wrong = 0;
  parallel_for(judged, [&](std::size_t i) {
    const std::span<const Ray> ray = rays.subspan(i * rays.size() / judged, 1);
    float t = 0.0f;
    tracer.closest(kSingle, ray, &t);
    wrong += judge_distance(world, ray.front(), t).has_value();
  });
  return wrong;
}

class CellRun {
 public:
  CellRun(const StabilityCell& cell, const StabilitySettings& settings)
      : cell_(cell),
        settings_(settings),
        scene_(stability_scene(cell, settings.seed)),
        trees_(scene_, {}),
        inside_(rays_of(stability_shape(cell.shape).probe, trees_.world(), settings)) {
    const double affordable = settings.oracle_tests / std::max(1.0, oracle_tests_per_ray(trees_.world()));
    judged_ = std::min(inside_.rays.size(), std::max<std::size_t>(1, static_cast<std::size_t>(affordable)));
  }

  std::string row() const {
    const Found ours = measure_ours();
    const std::optional<Found> peer = measure_peer();
    JsonRow row;
    row.add("shape", cell_.shape);
    row.add("probe", probe_name(stability_shape(cell_.shape).probe));
    row.add("motion", cell_.motion);
    row.add("degenerate", stability_motion(cell_.motion).degenerate);
    row.add("keys", key_count(cell_.form.segments));
    row.add("degree", cell_.form.degree);
    row.add("position", cell_.place.position);
    row.add("scale", cell_.place.scale);
    row.add("rays", inside_.rays.size());
    row.add("rays_at_keys", static_cast<std::size_t>(std::ranges::count_if(inside_.rays, is_at_key)));
    row.add("judged", judged_);
    for (const InsideAim aim : kInsideAims)
      row.add((std::string("rays ") + inside_aim_name(aim)).c_str(),
              static_cast<std::size_t>(std::ranges::count(inside_.aims, aim)));
    write(row, "", ours);
    write(row, "peer_", peer);
    return row.text();
  }

 private:
  static InsideRays rays_of(StabilityProbe probe, const Bvh& world, const StabilitySettings& settings) {
    if (probe == StabilityProbe::kIntoRound) {
      InsideRays rays;
      rays.rays = rays_into_round(world, settings.rays, settings.seed);
      rays.aims.assign(rays.rays.size(), InsideAim::kAnywhere);
      return rays;
    }
    const ShownMeshes shown(world);
    const std::vector<const ShownMesh*> closed = closed_meshes(shown);
    const std::size_t meshes = std::max<std::size_t>(1, closed.size());
    const bool plain = probe == StabilityProbe::kInsidePlain;
    const std::size_t count = plain ? kPlainRays * settings.rays : settings.rays;
    const std::size_t starts = std::max<std::size_t>(1, count / (kRaysOfStart * meshes));
    InsideRays rays = inside_rays(shown, closed, starts, count, settings.seed,
                                  plain ? InsideMix::kPlain : InsideMix::kHard);
    rays.from.clear();  // do not outlive `shown`
    return rays;
  }

  Found measure_ours() const {
    Found found;
    for (const InstructionSet set : supported_instruction_sets()) {
      settings_.tick();
      const OurTracerUnderTest ours(trees_.world(), set);
      count_leaks(ours, inside_, found);
      found.wrong =
          std::max(found.wrong.value_or(0), count_wrong(ours, trees_.world(), inside_.rays, judged_));
    }
    return found;
  }

  // None where there is no peer, or no track that it has is this one.
  std::optional<Found> measure_peer() const {
    if (!settings_.peer || cell_.form.degree > 1) return std::nullopt;
    settings_.tick();
    PeerInput input;
    fill_peer_input(*scene_, 0.0, input);
    if (!input.missing.empty() || input.sampled) return std::nullopt;
    const PeerUnderTest peer(*settings_.peer, input.scene);
    Found found;
    count_leaks(peer, inside_, found);
    // Another tracer may close tubes otherwise, and be right.
    if (trees_.world().curves.empty()) found.wrong = count_wrong(peer, trees_.world(), inside_.rays, judged_);
    return found;
  }

  static void write(JsonRow& row, const std::string& side, const std::optional<Found>& found) {
    const auto add = [&](const std::string& key, std::size_t Found::*figure) {
      row.add((side + key).c_str(), found ? static_cast<double>((*found).*figure) : kNotMeasured);
    };
    add("leaks", &Found::leaks);
    add("leaks_at_keys", &Found::at_keys);
    const bool judged = found && found->wrong;
    row.add((side + "wrong").c_str(), judged ? static_cast<double>(*found->wrong) : kNotMeasured);
    for (const InsideAim aim : kInsideAims) {
      const double leaks =
          found ? static_cast<double>(found->of_aims[static_cast<std::size_t>(aim)]) : kNotMeasured;
      row.add((side + "leaks " + inside_aim_name(aim)).c_str(), leaks);
    }
  }

  const StabilityCell& cell_;
  const StabilitySettings& settings_;
  const std::shared_ptr<const Scene> scene_;
  const Trees trees_;
  const InsideRays inside_;
  std::size_t judged_ = 0;
};

}  // namespace

std::string run_stability(const StabilityCell& cell, const StabilitySettings& settings) {
  return CellRun(cell, settings).row();
}

}  // namespace msbvh::bench
