// The scenes that effects are measured on call for those effects alone, and something is seen in each.
#include <algorithm>
#include <doctest/doctest.h>

#include "bench/ablation_scenes.h"
#include "core/api/renderer.h"
#include "core/base/error.h"
#include "core/plan/effect_plan.h"

using namespace msbvh;
using namespace msbvh::bench;

TEST_CASE("a scene that is made for an effect calls for it, for what it needs, and for no other") {
  for (std::size_t i = 0; i < kEffectCount; ++i) {
    const Effect effect = effect_at(i);
    CAPTURE(effect_name(effect));
    const EffectSet expected = needed_by(effect).with(effect);
    const CallingScene calling = scene_calling_for(expected, 2000);
    RenderSettings settings{.width = 16,
                            .height = 16,
                            .spp = 1,
                            .max_bounces = calling.max_bounces,
                            .refraction = calling.refraction,
                            .aovs = calling.aovs,
                            .build = {}};
    Renderer renderer;
    renderer.commit(calling.scene, settings);
    CHECK(renderer.plan().set == expected);
    CHECK(std::ranges::any_of(renderer.render().rgba,
                              [](float value) { return value > 0.0f && value < 1.0f; }));
  }
}

TEST_CASE("a scene cannot be made for an effect without what it needs") {
  CHECK_THROWS_WITH_AS(scene_calling_for(EffectSet{}.with(Effect::kMovingInstances), 2000),
                       "ablation scene: found a plan of no effects; expected moving instances", Error);
}
