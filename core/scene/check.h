// What validate() (scene.h) checks, in parts.
#pragma once

#include <cstddef>
#include <string>

#include "core/scene/scene.h"

namespace msbvh {

// Throw Error naming the part, what of it, found and expected.
void expect(bool holds, const std::string& part, const std::string& attribute, const std::string& found,
            const std::string& expected);
void expect_index(std::size_t index, std::size_t size, const std::string& part, const std::string& attribute);

void check_material(const Material& material, const Scene& scene, const std::string& part);
void check_texture(const ImageTexture& texture, const std::string& part);
void check_primvar_names(const Scene& scene);

}  // namespace msbvh
