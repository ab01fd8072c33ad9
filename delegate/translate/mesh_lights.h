// Lights whose shape is a mesh of the scene: from the path of a prim to every place where it stands.
#pragma once

#include <vector>

#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// A light of which all but its places is known. Its radiance is not yet normalised.
struct MeshLightDraft {
  Light light;
  MeshSurface surface;
};

// What rays may reach counts on lights: one of each, before anything is left out of a scene.
void add_stand_ins(const std::vector<MeshLightDraft>& drafts, Scene& scene);

// In their stead one light for each place of each mesh of that path, in the world or shown by an instance.
// Normalised radiance is divided by the area in the world, at the keys of what changes it. Says where there
// is none, or where glow that varies over the surface is left out of the light's colour.
void place_mesh_lights(const std::vector<MeshLightDraft>& drafts, Scene& scene,
                       std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
