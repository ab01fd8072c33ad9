// Colour by the way of its light, for AOVs.
//
// Stages add to a path's radiance whatever they are asked for; what they added is sorted behind each of them,
// so that none of them has code for it and colour keeps its bits. A difference of sums errs by a rounding.
#pragma once

#include <span>

#include "core/film/aov_sums.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Gives `specular` its share, by path, of what every path's radiance has gained since the last call.
void credit_specular(PathBatch& batch, std::span<const Vec3f> share);
// By channel: of light that a surface reflects one way.
Vec3f specular_share(const Vec3f& specular, const Vec3f& all);

// Puts down what every path's radiance has gained since the last call as light of that way.
void sort_light(PathBatch& batch, LightPath way);

}  // namespace msbvh
