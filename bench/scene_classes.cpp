#include "bench/scene_classes.h"

#include <cstring>
#include <string>

#include "bench/scene_makers.h"
#include "core/base/error.h"

namespace msbvh::bench {
namespace {

constexpr TrackForm kStill{0, 1};
constexpr TrackForm kLinear2{1, 1}, kLinear3{2, 1}, kLinear5{4, 1}, kLinear9{8, 1}, kLinear33{32, 1},
    kLinear129{128, 1};

const std::vector<SceneClass>& classes() {
  static const std::vector<SceneClass> kClasses = {
      {"hairball",
       "strands that swing from a ball",
       300000,
       20000,
       {kStill, kLinear2, kLinear9},
       {kLinear2},
       hairball},
      {"fences",
       "long thin bars in rows under one coherent motion",
       120000,
       20000,
       {kStill, kLinear2},
       {kLinear2},
       fences},
      {"wheels",
       "spinning wheels of thin spokes",
       60000,
       20000,
       {kLinear9, kLinear33, kLinear129},
       {kLinear9},
       spinning_wheels},
      {"twist",
       "a closed dense mesh, like a scan, that twists",
       2000000,
       40000,
       {kStill, kLinear2},
       {kStill, kLinear2},
       twist},
      {"cloth", "three waving sheets", 300000, 20000, {kLinear5, kLinear9}, {kLinear5}, cloth},
      {"debris",
       "shards with velocities and spins of their own",
       400000,
       20000,
       {kStill, kLinear2, kLinear9},
       {kLinear2, kLinear9},
       debris},
      {"room",
       "a closed still room with one fast spinning ball",
       300000,
       20000,
       {kLinear9},
       {kLinear9},
       room},
      {"crowd",
       "500 moving instances of four deforming bodies",
       40000,
       10000,
       {kLinear2, kLinear5},
       {kLinear3},
       crowd},
      {"rods",
       "500 long thin moving instances that cross each other",
       10000,
       2500,
       {kLinear2, kLinear3},
       {kLinear3},
       rods},
      {"ballistic",
       "shards on parabolas: one quadratic segment",
       100000,
       20000,
       {{1, 2}},
       {{1, 2}},
       ballistic},
      {"spin", "spinning wheels on cubic segments", 60000, 20000, {{2, 3}}, {{2, 3}}, spinning_wheels},
      {"subdiv",
       "a twisting cage's limit surface, each edge cut by its length",
       300000,
       20000,
       {kStill, kLinear2, kLinear9},
       {kLinear2},
       subdiv},
      {"displaced",
       "a twisting cage's displaced limit surface, as patches; the peer has their triangles",
       500000,
       30000,
       {kStill, kLinear2, kLinear9},
       {kLinear2},
       displaced},
      {"hair",
       "strands of eight cubic spans, as ribbons, that sway on a ball",
       800000,
       16000,
       {kStill, kLinear2, kLinear3, kLinear9},
       {kLinear2},
       hair},
      {"grass",
       "blades of two cubic spans, as ribbons, in a wind",
       400000,
       16000,
       {kStill, kLinear2, kLinear9},
       {kLinear2},
       grass},
      {"particles",
       "balls with velocities of their own",
       1000000,
       20000,
       {kStill, kLinear2, kLinear9},
       {kLinear2},
       particles},
      {"mini", "shards, as few as 10 thousand", 10000, 10000, {kLinear2}, {kLinear2}, debris},
  };
  return kClasses;
}

}  // namespace

std::span<const SceneClass> scene_classes() { return classes(); }

const SceneClass& scene_class(const char* name) {
  std::string known;
  for (const SceneClass& c : classes()) {
    if (std::strcmp(c.name, name) == 0) return c;
    known += (known.empty() ? "" : ", ") + std::string(c.name);
  }
  throw Error("bench: found the scene \"" + std::string(name) + "\"; expected one of " + known);
}

}  // namespace msbvh::bench
