// The kinds of scene that are measured: seeded, procedural, closed where their nature is closed. The same
// seed makes the same scene on any machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace msbvh::bench {

// A ball inside a closed scene: a ray that starts in it hits something at any time. Radius 0: none.
struct Interior {
  Vec3f center;
  float radius = 0.0f;
};

struct BenchScene {
  std::shared_ptr<const Scene> scene;
  Interior interior;
};

struct SceneClass {
  const char* name;
  const char* what;               // one line, for people
  std::uint32_t triangles;        // about so many, in a full run
  std::uint32_t quick_triangles;  // and in a quick one
  std::vector<TrackForm> forms;   // that are measured; the quick run takes those marked by `quick_forms`
  std::vector<TrackForm> quick_forms;
  BenchScene (*make)(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
};

std::span<const SceneClass> scene_classes();
// Throws Error for a name that is none of them.
const SceneClass& scene_class(const char* name);

}  // namespace msbvh::bench
