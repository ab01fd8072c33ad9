// What takes the place of a surface's Bsdf where it is of glass, or a hair.
#pragma once

#include <variant>

#include "core/shade/bsdf/fibre.h"
#include "core/shade/bsdf/glass.h"

namespace msbvh {

// monostate: nothing does.
using SpecialLobe = std::variant<std::monostate, Glass, Fibre>;

inline bool is_special(const SpecialLobe& lobe) { return !std::holds_alternative<std::monostate>(lobe); }

// Whether light may come from a direction, by its cosines to the shading normal and the geometric one.
inline bool takes_light(const SpecialLobe& lobe, float shading_cosine, float geometric_cosine) {
  if (std::holds_alternative<Fibre>(lobe)) return true;
  if (shading_cosine > 0.0f && geometric_cosine > 0.0f) return true;
  return std::holds_alternative<Glass>(lobe) && shading_cosine < 0.0f && geometric_cosine < 0.0f;
}

// The normal by which lights are chosen: none where light counts from either side (light_tree.h).
inline Vec3f lit_side(const SpecialLobe& lobe, const Vec3f& normal) {
  return is_special(lobe) ? Vec3f{} : normal;
}

// Of light from everywhere: what is scattered.
inline Vec3f albedo_of(const SpecialLobe& lobe, const Bsdf& bsdf) {
  if (std::holds_alternative<Glass>(lobe)) return {1.0f, 1.0f, 1.0f};
  if (const Fibre* fibre = std::get_if<Fibre>(&lobe)) return fibre->albedo();
  return bsdf.albedo();
}

inline Bsdf::Value value_of(const SpecialLobe& lobe, const Bsdf& bsdf, const Vec3f& normal, const Vec3f& in) {
  if (const Glass* glass = std::get_if<Glass>(&lobe)) return glass->at(normal, in);
  if (const Fibre* fibre = std::get_if<Fibre>(&lobe)) return fibre->at(in);
  return bsdf.at(normal, in);
}

inline BsdfSample sample_of(const SpecialLobe& lobe, const Bsdf& bsdf, const Vec3f& normal, float which,
                            Point2 random) {
  if (const Glass* glass = std::get_if<Glass>(&lobe)) return glass->sample(normal, which, random);
  if (const Fibre* fibre = std::get_if<Fibre>(&lobe)) return fibre->sample(which, random);
  return bsdf.sample(normal, which, random);
}

}  // namespace msbvh
