// Light that a light sends to a point: from a direction of the light's own choice, or from one that something
// else has chosen. All lights but the constant dome, which lies behind everything.
#pragma once

#include "core/plan/effect_variant.h"
#include "core/scene/scene.h"
#include "core/shade/point2.h"

namespace msbvh {

// A direction to a light from a point. The expectation of `irradiance` * cos(theta), over the samples, is the
// irradiance of a surface whose normal is at the angle theta to `direction`.
struct LightSample {
  Vec3f direction;   // unit, in the world
  float distance;    // to the light along it; infinite for a distant light
  Vec3f irradiance;  // at normal incidence: radiance over the density of the direction
  float pdf = 0.0f;  // of the direction, per steradian; 0: the light has no extent, no other ray meets it
  bool casts_shadow = true;
  // What diffuse and other reflection take of it; 1 without light controls.
  float diffuse = 1.0f, specular = 1.0f;
};

// The light where a ray from a point meets it.
struct LightAlong {
  Vec3f radiance;
  float distance;
  float pdf;                              // that sample_light() takes the ray's direction, per steradian
  float diffuse = 1.0f, specular = 1.0f;  // as in LightSample
};

// A light where it is and as it shines at one time.
struct PlacedLight {
  LightKind kind;
  LightValues values;
  Affine3f world_from_light;  // of an image dome a rotation
  const Light* source;
  float time;
  bool shaped = false;  // is_shaped()
  // Of the kind that each is for.
  Affine3f light_from_world;  // cylinder, and where an IES profile shapes it
  Vec3f axis;                 // distant, and what is shaped: its +z, unit; zero for none
  float opening = 0.0f;       // distant: 1 - cos of the half angle
  float radius = 0.0f;        // sphere: in the world
  Vec3f dark_area;  // rect and disk: normal on the side of +z, where it does not shine, as long as its area

  PlacedLight(const Light& light, float time);
};

// False where the light does not shine on `point` from the sampled direction. kExtended: lights may have an
// extent. kControls: they may have what the effect "light controls" stands for.
template <bool kExtended = kKnownEffects.has(Effect::kAreaLights),
          bool kControls = kKnownEffects.has(Effect::kLightControls)>
bool sample_light(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                  Point2 random, LightSample& sample);
template <bool kExtended = kKnownEffects.has(Effect::kAreaLights),
          bool kControls = kKnownEffects.has(Effect::kLightControls)>
bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample);

// False where a ray from `point` in the unit `direction` does not meet the light, or its dark side.
template <bool kControls = kKnownEffects.has(Effect::kLightControls)>
bool find_light(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);
template <bool kControls = kKnownEffects.has(Effect::kLightControls)>
bool find_light(const Light& light, const Vec3f& point, const Vec3f& direction, float time,
                LightAlong& along);

// Whether a ray can meet the light at some time.
bool has_extent(const Light& light);

// At a time of the shutter.
LightValues values_at(const Light& light, float time);

}  // namespace msbvh
