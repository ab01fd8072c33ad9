#include "core/shade/bsdf/bsdf.h"

#include <algorithm>
#include <cmath>

#include "core/shade/bsdf/albedo_tables.h"
#include "core/shade/bsdf/microfacet.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// Below it, directions that leave are taken as grazing: shading normals may turn a surface away from who sees
// it.
constexpr float kLeastCosine = 1e-4f;
// Of what is left of the light, below which a lobe has nothing to give.
constexpr float kLeast = 1e-5f;

const Vec3f kWhite{1.0f, 1.0f, 1.0f};

float mean_of(const Vec3f& color) { return (color.x + color.y + color.z) * (1.0f / 3.0f); }

Vec3f divided(const Vec3f& a, const Vec3f& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

Vec3f at_least(const Vec3f& a, float least) {
  return {std::max(a.x, least), std::max(a.y, least), std::max(a.z, least)};
}

Vec3f reflected(const Vec3f& f0, const Vec3f& f90, const LobeAlbedo& albedo) {
  return f0 * albedo.straight + f90 * albedo.grazing;
}

// Light that microfacets reflect among each other comes out tinted by each of its reflections: a geometric
// series of the mean reflectance, whose share that gets out is the mean albedo at every turn.
Vec3f missing_reflectance(const Vec3f& f0, const Vec3f& f90, float mean_albedo) {
  const Vec3f f = f0 * (20.0f / 21.0f) + f90 * (1.0f / 21.0f);
  return divided(f * f * mean_albedo, at_least(kWhite - f * (1.0f - mean_albedo), kLeast));
}

Vec3f fresnel(const Vec3f& f0, const Vec3f& f90, float cosine) {
  return f0 + (f90 - f0) * schlick_weight(cosine);
}

bool is_dark(const Vec3f& color) { return color == Vec3f{}; }

}  // namespace

Bsdf::Bsdf(const SurfaceLook& look, const Vec3f& normal, const Vec3f& out) : look_(look) {
  const Basis basis(normal);
  out_ = {dot(out, basis.x), dot(out, basis.y), dot(out, basis.z)};
  if (out_.z < kLeastCosine) out_ = normalize(Vec3f{out_.x, out_.y, kLeastCosine});
  const AlbedoTables& tables = AlbedoTables::get();
  Vec3f below = kWhite, below_mean = kWhite;  // what the specular lobe lets through
  Vec3f single, between;
  if (!is_dark(look.f90)) {
    const LobeAlbedo here = tables.at(out_.z, look.alpha), mean = tables.mean(look.alpha);
    missing_ = missing_reflectance(look.f0, look.f90, mean.total());
    single = reflected(look.f0, look.f90, here);
    between = missing_ * (1.0f - here.total());
    below = at_least(kWhite - single - between, 0.0f);
    below_mean = kWhite - reflected(look.f0, look.f90, mean) - missing_ * (1.0f - mean.total());
    between_ = between * (1.0f / (kPi * std::max(kLeast, 1.0f - mean.total())));
  }
  const Vec3f diffuse = look.diffuse * below;
  diffuse_ = divided(diffuse, at_least(below_mean, kLeast)) * (1.0f / kPi);
  float coat = 0.0f, coat_single = 0.0f;
  if (look.coat > 0.0f) {
    const LobeAlbedo here = tables.at(out_.z, look.coat_alpha), mean = tables.mean(look.coat_alpha);
    const Vec3f f0{look.coat_f0, look.coat_f0, look.coat_f0};
    const float tint = missing_reflectance(f0, kWhite, mean.total()).x;
    coat_single = look.coat * reflected(f0, kWhite, here).x;
    const float coat_rest = look.coat * tint * (1.0f - here.total());
    coat_between_ = coat_rest / (kPi * std::max(kLeast, 1.0f - mean.total()));
    coat = coat_single + coat_rest;
    coat_passed_ = 1.0f - coat;
  }
  albedo_ = Vec3f{coat, coat, coat} + (single + between + diffuse) * coat_passed_;
  const float specular = coat_passed_ * mean_of(single);
  const float cosine = coat_passed_ * mean_of(diffuse + between) + coat - coat_single;
  const float all = coat_single + specular + cosine;
  if (!(all > 0.0f)) return;
  choose_coat_ = coat_single / all;
  choose_specular_ = specular / all;
}

Bsdf::Value Bsdf::at_local(const Vec3f& in) const {
  if (in.z <= 0.0f) return {{}, {}, 0.0f};
  Value value{{}, {}, (1.0f - choose_coat_ - choose_specular_) * in.z * (1.0f / kPi)};
  const Vec3f halfway = normalize(out_ + in);
  const float cosine = dot(out_, halfway);
  const AlbedoTables& tables = AlbedoTables::get();
  Vec3f passed = kWhite;
  if (!is_dark(look_.f90)) {
    const LobeAlbedo way_in = tables.at(in.z, look_.alpha);
    const Vec3f between = missing_ * (1.0f - way_in.total());
    passed = at_least(kWhite - reflected(look_.f0, look_.f90, way_in) - between, 0.0f);
    const float density = ggx_density(halfway, look_.alpha);
    const float lobe = density * smith_visible(out_, in, look_.alpha) / (4.0f * out_.z);
    value.specular =
        fresnel(look_.f0, look_.f90, cosine) * lobe + between_ * ((1.0f - way_in.total()) * in.z);
    value.pdf += choose_specular_ * mirrored_density(out_, halfway, look_.alpha);
  }
  value.diffuse = diffuse_ * passed * in.z;
  if (look_.coat > 0.0f) {
    const Vec3f f0{look_.coat_f0, look_.coat_f0, look_.coat_f0};
    const LobeAlbedo way_in = tables.at(in.z, look_.coat_alpha), mean = tables.mean(look_.coat_alpha);
    const float rest = 1.0f - way_in.total();
    const float tint = missing_reflectance(f0, kWhite, mean.total()).x;
    const float through =
        coat_passed_ * (1.0f - look_.coat * (reflected(f0, kWhite, way_in).x + tint * rest));
    const float lobe = look_.coat * fresnel(f0, kWhite, cosine).x * ggx_density(halfway, look_.coat_alpha) *
                       smith_visible(out_, in, look_.coat_alpha) / (4.0f * out_.z);
    const float coat = lobe + coat_between_ * rest * in.z;
    value.diffuse = value.diffuse * through;
    value.specular = value.specular * through + Vec3f{coat, coat, coat};
    value.pdf += choose_coat_ * mirrored_density(out_, halfway, look_.coat_alpha);
  }
  return value;
}

Bsdf::Value Bsdf::at(const Vec3f& normal, const Vec3f& in) const {
  const Basis basis(normal);
  return at_local({dot(in, basis.x), dot(in, basis.y), dot(in, basis.z)});
}

BsdfSample Bsdf::sample(const Vec3f& normal, float lobe, Point2 random) const {
  Vec3f in;
  if (lobe < choose_coat_) {
    in = mirrored(out_, sample_visible_normal(out_, look_.coat_alpha, random));
  } else if (lobe < choose_coat_ + choose_specular_) {
    in = mirrored(out_, sample_visible_normal(out_, look_.alpha, random));
  } else {
    in = sample_cosine_hemisphere(random);
  }
  const Value value = at_local(in);
  if (!(value.pdf > 0.0f)) return {};
  const float per_pdf = 1.0f / value.pdf;
  return {Basis(normal)(in), value.pdf, value.both() * per_pdf, value.specular * per_pdf};
}

}  // namespace msbvh
