// The gate of materials, textures and primvar names. Throw Error naming the part, what of it, found and
// expected.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace msbvh {

void check_material(const Material& material, const Scene& scene, const std::string& part);
void check_texture(const ImageTexture& texture, const std::string& part);
void check_primvar_names(const Scene& scene);

}  // namespace msbvh
