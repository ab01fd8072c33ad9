// What each effect costs, as lines of JSON; docs/make_ablation.py makes docs/ablation.md of them.
//
//   msbvh_bench_ablation effects [TRIANGLES [WIDTH [ROUNDS [EFFECT]]]]
//       A line for each effect: the base scene, or that with what the effect needs, against the same with the
//       effect, rendered in turn. EFFECT: only the one of this name.
//   msbvh_bench_ablation base INSTRUCTIONS [TRIANGLES [WIDTH]]
//       The base scene's frame, once, by the kernels of one instruction set: sse4, avx2 or avx3. For
//       callgrind, and for builds that leave an effect out (MSBVH_OMIT_EFFECTS).
//
// One thread; 4 samples a pixel of a square image.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>

#include "bench/ablation_scenes.h"
#include "bench/json_row.h"
#include "bench/timing.h"
#include "core/api/renderer.h"
#include "core/base/error.h"

namespace {

using namespace msbvh;
using namespace msbvh::bench;

constexpr std::uint32_t kSpp = 4;
constexpr std::uint32_t kTriangles = 20'000, kWidth = 256;
constexpr int kRounds = 15, kLeastRounds = 5;
constexpr double kMostSeconds = 20.0;  // an effect

// FNV-1a, of the bits of the pixels.
std::string hash_of(const Image& image) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto* bytes = reinterpret_cast<const unsigned char*>(image.rgba.data());
  for (std::size_t i = 0; i < image.rgba.size() * sizeof(float); ++i)
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

InstructionSet instructions_named(const std::string& name) {
  std::string known;
  for (const InstructionSet set : supported_instruction_sets()) {
    if (name == instruction_set_name(set)) return set;
    known.append(known.empty() ? "" : ", ").append(instruction_set_name(set));
  }
  throw Error("instructions: found \"" + name + "\"; expected one that this machine has: " + known);
}

void commit(Renderer& renderer, EffectSet effects, std::uint32_t triangles, std::uint32_t width,
            std::optional<InstructionSet> instructions = {}) {
  CallingScene calling = scene_calling_for(effects, triangles);
  RenderSettings settings;
  settings.width = settings.height = width;
  settings.spp = kSpp;
  settings.threads = 1;
  settings.max_bounces = calling.max_bounces;
  settings.refraction = calling.refraction;
  settings.aovs = calling.aovs;
  settings.instruction_set = instructions;
  renderer.commit(calling.scene, settings);
}

std::uint64_t tree_bytes(const Renderer& renderer) {
  const BvhStatistics& trees = renderer.statistics().accel;
  return trees.total_bytes() + trees.grid_bytes;
}

void print(const JsonRow& row) {
  std::puts(row.text().c_str());
  std::fflush(stdout);
}

void measure(Effect effect, std::uint32_t triangles, std::uint32_t width, int rounds) {
  const EffectSet without = needed_by(effect), with = without.with(effect);
  Renderer renderers[2];
  commit(renderers[0], without, triangles, width);
  commit(renderers[1], with, triangles, width);
  for (Renderer& renderer : renderers) renderer.render();
  const auto seconds =
      interleave(2, rounds, kLeastRounds, kMostSeconds, [&](std::size_t side) { renderers[side].render(); });
  std::vector<double> ratios;
  for (std::size_t i = 0; i < seconds[0].size(); ++i) ratios.push_back(seconds[1][i] / seconds[0][i]);
  const Spread ratio = spread_of(ratios);
  std::string needs;
  for (const Reason& reason : renderers[0].plan().why)
    needs.append(needs.empty() ? "" : ", ").append(effect_name(reason.effect));
  JsonRow row;
  row.add("effect", effect_name(effect));
  row.add("needs", needs);
  row.add("triangles", triangles);
  row.add("width", width);
  row.add("rounds", static_cast<std::uint32_t>(ratios.size()));
  row.add("without_seconds", spread_of(seconds[0]).median);
  row.add("with_seconds", spread_of(seconds[1]).median);
  row.add("ratio", ratio.median);
  row.add("ratio_low", ratio.low);
  row.add("ratio_high", ratio.high);
  row.add("without_bytes", tree_bytes(renderers[0]));
  row.add("with_bytes", tree_bytes(renderers[1]));
  row.add("without_rays", renderers[0].statistics().rays.rays());
  row.add("with_rays", renderers[1].statistics().rays.rays());
  print(row);
}

void render_base(const std::string& instructions, std::uint32_t triangles, std::uint32_t width) {
  Renderer renderer;
  commit(renderer, {}, triangles, width, instructions_named(instructions));
  const Image image = renderer.render();
  JsonRow row;
  row.add("instructions", instructions);
  row.add("triangles", triangles);
  row.add("width", width);
  row.add("hash", hash_of(image));
  row.add("seconds", renderer.statistics().trace_seconds);
  row.add("bytes", tree_bytes(renderer));
  print(row);
}

void run(int argc, char** argv) {
  const auto number = [&](int i, std::uint32_t fallback) {
    const auto found = argc > i ? static_cast<std::uint32_t>(std::strtoul(argv[i], nullptr, 10)) : fallback;
    if (found == 0)
      throw Error(std::string("argument: found \"") + argv[i] + "\"; expected a number above 0");
    return found;
  };
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "base" && argc > 2) return render_base(argv[2], number(3, kTriangles), number(4, kWidth));
  if (what != "effects")
    throw Error("expected effects or base INSTRUCTIONS; see the head of bench/ablation.cpp");
  bool found = false;
  for (std::size_t i = 0; i < kEffectCount; ++i) {
    const Effect effect = effect_at(i);
    if (argc > 5 && std::strcmp(effect_name(effect), argv[5]) != 0) continue;
    found = true;
    measure(effect, number(2, kTriangles), number(3, kWidth), static_cast<int>(number(4, kRounds)));
  }
  if (!found)
    throw Error(std::string("EFFECT: found \"") + argv[5] + "\"; expected one that msbvh plan names");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "msbvh_bench_ablation: error: %s\n", error.what());
    return 1;
  }
}
