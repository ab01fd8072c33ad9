// One scene class, one line of JSON a row: for profilers, without Python. `msbvh bench` is the full harness.
//
//   msbvh_bench SCENE [TRIANGLES [SEGMENTS [DEGREE [KIND [REPETITIONS [BUILDER [PEER.so FOLDER]]]]]]]
//
// KIND: primary, shadow, random or all. BUILDER: its name, with "/compact" for the compact layout, or with
// "/both" for both side by side. FOLDER: of the peer's own libraries (embreex.libs). One thread. Without
// arguments it prints the scene classes.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "bench/run_scene.h"
#include "core/base/error.h"

namespace {

using namespace msbvh::bench;
using msbvh::kTreeLayouts;
using msbvh::TreeLayout;
using msbvh::TreeLayoutName;

std::vector<TreeLayout> layouts_of(const std::string& name) {
  if (name == "both") return {TreeLayout::kFull, TreeLayout::kCompact};
  for (const TreeLayoutName& known : kTreeLayouts) {
    if (name == known.name) return {known.layout};
  }
  throw msbvh::Error("layout: found \"" + name + "\"; expected full, compact or both");
}

void run(int argc, char** argv) {
  const auto number = [&](int i, std::uint32_t fallback) {
    return argc > i ? static_cast<std::uint32_t>(std::strtoul(argv[i], nullptr, 10)) : fallback;
  };
  const SceneClass& kind = scene_class(argv[1]);
  const BenchScene scene = kind.make(number(2, kind.quick_triangles), {number(3, 1), number(4, 1)}, 1);
  RunSettings settings;
  settings.name = kind.name;
  settings.threads = {1};
  settings.robust = {true};
  settings.build_repetitions = 1;
  settings.repetitions = static_cast<int>(number(6, 5));
  settings.oracle_tests = 0.0;
  if (argc > 5 && std::string(argv[5]) != "all") {
    std::erase_if(settings.kinds, [&](RayKind k) { return std::string(argv[5]) != ray_kind_name(k); });
  }
  const std::string builder = argc > 7 ? argv[7] : "msbvh";
  const std::size_t slash = builder.find('/');
  settings.builders = {builder.substr(0, slash)};
  if (slash != std::string::npos) settings.layouts = layouts_of(builder.substr(slash + 1));
  std::optional<PeerLibrary> peer;
  if (argc > 9) settings.peer = &peer.emplace(argv[8], argv[9]);
  for (const std::string& row : run_scene(scene, settings)) std::puts(row.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    for (const SceneClass& kind : scene_classes()) std::printf("%-10s %s\n", kind.name, kind.what);
    return 2;
  }
  try {
    run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "msbvh_bench: error: %s\n", error.what());
    return 1;
  }
}
