// The other ways to show a scene: what a feature spares.
#pragma once

#include <memory>
#include <string>

#include "core/scene/scene.h"

namespace msbvh::bench {

using ScenePtr = std::shared_ptr<const Scene>;

// "9 keys", "1 quadratic segment".
std::string form_text(const TrackForm& form);
TrackForm finest_form(const Scene& scene);

// World meshes on curves as linear keys, the fewest that stay within a tenth of a pixel of 960 across it.
ScenePtr with_linear_keys(const ScenePtr& scene);

// Every instance of a linear mesh under a linear transform as a mesh of its own. Exact: the product of the
// two is quadratic. Prototypes hold one mesh and have the instances' segments.
ScenePtr flattened(const Scene& scene);

// World meshes a shutter later: each vertex goes on as it came.
ScenePtr next_frame(const Scene& scene);

}  // namespace msbvh::bench
