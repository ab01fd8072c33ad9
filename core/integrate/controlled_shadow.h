// Shadow rays of lights with shadow settings: UsdLux's ShadowAPI and shadow linking.
#pragma once

#include "core/integrate/path_batch.h"

namespace msbvh {

struct Frame;

// In place of ShadowQueue::add(). Adds the light at once where nothing shadows it.
void add_controlled_shadow(const Light& light, const Ray& ray, PathIndex path, const Vec3f& contribution,
                           PathBatch& batch);

// In place of trace_shadows(), for rays that were all added so. What absorbs a share of a ray shadows that
// share of the light, by the strength that shadows have at its distance.
void trace_controlled_shadows(const Frame& frame, PathBatch& batch);

// In [0, 1]: of the shadow that what stands at a distance casts.
float shadow_strength(const LightShadow& shadow, float distance);
// What is left of light of which a share is shadowed.
Vec3f shadowed_light(const LightShadow& shadow, const Vec3f& light, float share);

}  // namespace msbvh
