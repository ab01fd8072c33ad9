#include "core/shade/light/light_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kMostImportance = 1e30f;  // a sum that stays finite with the tree's

float image_mean(const Light& light) { return light.image ? light.image->mean : 1.0f; }

// Its irradiance at normal incidence, about, at such a distance squared where the light has a place.
float irradiance(const Light& light, const LightValues& values, float distance_squared) {
  const float radiance = std::max({values.radiance.x, values.radiance.y, values.radiance.z, 0.0f});
  switch (light.kind) {
    case LightKind::kDistant: {
      const float sine = std::sin(values.angle_degrees * (kPi / 360.0f));
      return radiance * (values.angle_degrees > 0.0f ? kPi * sine * sine : 1.0f);
    }
    case LightKind::kSphere: {
      const float radius = world_radius(values.radius, light.world_from_light.front());
      return radiance * (values.radius > 0.0f ? kPi * radius * radius : 1.0f) / distance_squared;
    }
    case LightKind::kRect:
      return radiance * image_mean(light) * length(dark_area(values, light.world_from_light.front())) /
             distance_squared;
    case LightKind::kDisk:
      return radiance * length(dark_disk_area(values.radius, light.world_from_light.front())) /
             distance_squared;
    case LightKind::kCylinder: {  // seen from its side
      const Affine3f& m = light.world_from_light.front();
      return radiance * 2.0f * values.radius * values.length * length(m.x) *
             std::sqrt(length(cross(m.y, m.z))) / distance_squared;
    }
    case LightKind::kCamera:
    case LightKind::kDome:
    case LightKind::kMesh:
      break;
  }
  return radiance * image_mean(light) * kPi;
}

float most_irradiance(const Light& light, float distance_squared) {
  if (light.moving_values.empty()) return irradiance(light, light, distance_squared);
  float most = 0.0f;
  for (const LightValues& values : light.moving_values)
    most = std::max(most, irradiance(light, values, distance_squared));
  return most;
}

// Unlikely to be asked where nothing is known of it.
float usable(float irradiance) {
  return irradiance < std::numeric_limits<float>::infinity() ? irradiance : 0.0f;  // NaN too
}

bool has_place(const Light& light) {
  return light.kind != LightKind::kDistant && light.kind != LightKind::kDome &&
         light.kind != LightKind::kCamera;
}

// Around what shines, in the light's space.
Box3f box_of(const Light& light, const LightValues& v) {
  switch (light.kind) {
    case LightKind::kRect:
      return {{-0.5f * v.width, -0.5f * v.height, 0.0f}, {0.5f * v.width, 0.5f * v.height, 0.0f}};
    case LightKind::kDisk:
      return {{-v.radius, -v.radius, 0.0f}, {v.radius, v.radius, 0.0f}};
    case LightKind::kCylinder:
      return {{-0.5f * v.length, -v.radius, -v.radius}, {0.5f * v.length, v.radius, v.radius}};
    default:
      break;
  }
  return {Vec3f{1, 1, 1} * -v.radius, Vec3f{1, 1, 1} * v.radius};
}

void grow_by(const Box3f& box, const Affine3f& world_from_light, LightReach& reach) {
  for (int corner = 0; corner < 8; ++corner) {
    reach.box.grow(world_from_light.point({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                           corner & 4 ? box.hi.z : box.lo.z}));
  }
}

// Where a still light shines; everywhere at some time, for one that moves.
void aim(const Light& light, LightReach& reach) {
  if (!is_still(light)) return;
  const PlacedLight placed(light, 0.0f);
  const bool flat = light.kind == LightKind::kRect || light.kind == LightKind::kDisk;
  const Vec3f behind = flat ? placed.dark_area : placed.world_from_light.z;
  if (!(length(behind) > 0.0f)) return;
  const float cone = light.cone_angle_degrees * (kPi / 180.0f), right = 0.5f * kPi;
  if (!flat && cone >= kPi) return;
  reach.axis = normalize(-behind);
  reach.cos_around = flat ? 1.0f : std::cos(std::max(cone - right, 0.0f));
  reach.cos_beyond = flat ? 0.0f : std::cos(std::min(cone, right));
}

// A mesh may shine anywhere.
LightReach reach_of(const MeshLight& mesh) {
  const Light& light = mesh.light();
  LightReach reach;
  reach.box = mesh.bounds();
  float brightest = 0.0f;
  const auto look_at = [&](const LightValues& v) {
    brightest = std::max({brightest, v.radiance.x, v.radiance.y, v.radiance.z});
  };
  if (light.moving_values.empty()) look_at(light);
  for (const LightValues& values : light.moving_values) look_at(values);
  reach.power = usable(brightest * static_cast<float>(mesh.area(0.0f)));
  return reach;
}

LightReach reach_of(const LightPick& pick) {
  if (pick.mesh) return reach_of(*pick.mesh);
  const Light& light = *pick.light;
  LightReach reach;
  reach.power = usable(most_irradiance(light, 1.0f));
  for (std::size_t key = 0; key < light.world_from_light.size(); ++key) {
    const bool moving = !light.moving_values.empty();
    grow_by(box_of(light, moving ? light.moving_values[key] : light), light.world_from_light[key], reach);
  }
  aim(light, reach);
  return reach;
}

auto key_of(const Light& light) {
  return std::tuple(light.surface.mesh, light.surface.set, light.surface.instance);
}

}  // namespace

LightSampler::LightSampler(const Scene& scene, const Box3f& bounds) : scene_(&scene), bounds_(bounds) {
  placed_.reserve(scene.lights.size());  // picks point into it
  for (const Light& light : scene.lights) {
    if (!shines(light)) continue;
    has_shadow_settings_ |= !(light.shadow == LightShadow{}) || !light.shadow_groups.empty();
    if (light.kind != LightKind::kDome || light.image) {
      const PlacedLight* still = is_still(light) ? &placed_.emplace_back(light, 0.0f) : nullptr;
      lights_.push_back({&light, still, 1.0f, has_extent(light)});
      if (light.kind == LightKind::kMesh) add_mesh(light);
      continue;
    }
    has_dome_ = true;
    if (light.moving_values.empty()) {
      still_dome_radiance_ += light.radiance;
    } else {
      moving_domes_.push_back(&light);
    }
  }
  picks_ = static_cast<std::uint32_t>(std::min<std::size_t>(kLightPicks, lights_.size()));
  if (lights_.size() > kLightPicks) weigh(bounds);
  sort_meshes();
}

void LightSampler::add_mesh(const Light& light) {
  shares_.resize(scene_->meshes.size());
  std::shared_ptr<const TriangleShares>& shares = shares_[light.surface.mesh];
  if (!shares)
    shares = std::make_shared<const TriangleShares>(scene_->mesh(mesh_id(light.surface.mesh)).shape);
  meshes_.push_back(std::make_unique<MeshLight>(*scene_, light, shares));
  lights_.back().mesh = meshes_.back().get();
}

void LightSampler::sort_meshes() {
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    if (lights_[i].mesh) by_surface_.push_back(i);
  }
  std::ranges::stable_sort(by_surface_, {}, [this](std::uint32_t i) { return key_of(*lights_[i].light); });
  // A ray that meets a mesh meets the first of its lights.
  for (std::size_t i = 1; i < by_surface_.size(); ++i) {
    const LightPick &pick = lights_[by_surface_[i]], &before = lights_[by_surface_[i - 1]];
    if (key_of(*pick.light) != key_of(*before.light)) continue;
    (*std::ranges::find(meshes_, pick.mesh, &std::unique_ptr<MeshLight>::get))->sample_alone();
  }
}

const LightPick* LightSampler::mesh_at(const HitSource& source) const {
  if (!source.mesh) return nullptr;
  const auto mesh = static_cast<std::uint32_t>(source.mesh - scene_->meshes.data());
  if (mesh >= shares_.size() || !shares_[mesh]) return nullptr;
  const std::uint32_t set = source.instances
                                ? static_cast<std::uint32_t>(source.instances - scene_->instances.data())
                                : LightSurface::kNoSet;
  const auto key = std::tuple(mesh, set, source.instance);
  const auto found = std::ranges::lower_bound(by_surface_, key, {},
                                              [this](std::uint32_t i) { return key_of(*lights_[i].light); });
  if (found == by_surface_.end() || key_of(*lights_[*found].light) != key) return nullptr;
  return &lights_[*found];
}

float LightSampler::expected(const LightPick& light, const Vec3f& point, const Vec3f& normal) const {
  if (!by_chance()) return 1.0f;
  const auto which = static_cast<std::uint32_t>(&light - lights_.data());
  return chance(which, importance(point, normal), point, normal) * static_cast<float>(picks_);
}

void LightSampler::weigh(const Box3f& bounds) {
  const Vec3f half = (bounds.hi - bounds.lo) * 0.5f;
  const float distance_squared = dot(half, half);
  std::vector<LightReach> reaches;
  float sum = 0.0f;
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    const Light& light = *lights_[i].light;
    std::vector<std::uint32_t>& list = has_place(light) ? placed_lights_ : distant_lights_;
    place_in_its_list_.push_back(static_cast<std::uint32_t>(list.size()));
    list.push_back(i);
    if (has_place(light)) {
      reaches.push_back(reach_of(lights_[i]));
    } else {
      sum = std::min(sum + usable(most_irradiance(light, distance_squared)), kMostImportance);
      cumulative_.push_back(sum);
    }
  }
  tree_ = LightTree(reaches);
}

float LightSampler::importance(const Vec3f& point, const Vec3f& normal) const {
  const float all = tree_.importance(point, normal);
  const std::uint8_t* seen = visibility_.at(point);
  return seen ? all * (float(seen[0]) * (1.0f / 255.0f)) : all;
}

LightSampler::Tried LightSampler::try_light(float random, const Vec3f& point, const Vec3f& normal) const {
  if (!(tree_.importance(point, normal) > 0.0f)) return {};
  const std::uint32_t light = tree_.pick(random, point, normal).light;
  return {&lights_[placed_lights_[light]], light};
}

float LightSampler::chance(std::uint32_t light, float importance, const Vec3f& point,
                           const Vec3f& normal) const {
  const auto alike = 1.0f / static_cast<float>(lights_.size());
  const float distant = cumulative_.empty() ? 0.0f : cumulative_.back(), all = distant + importance;
  if (!(all > 0.0f)) return alike;
  const std::uint32_t place = place_in_its_list_[light];
  const float share = has_place(*lights_[light].light)
                          ? importance * tree_.chance(place, point, normal, visibility_.at(point))
                          : cumulative_[place] - (place > 0 ? cumulative_[place - 1] : 0.0f);
  return kAlikeShare * alike + (1.0f - kAlikeShare) * (share / all);
}

std::uint32_t LightSampler::found(float random, float importance, const Vec3f& point,
                                  const Vec3f& normal) const {
  const float distant = cumulative_.empty() ? 0.0f : cumulative_.back(), all = distant + importance;
  const auto count = static_cast<float>(lights_.size());
  const auto last = static_cast<std::uint32_t>(lights_.size() - 1);
  if (!(all > 0.0f)) return std::min(static_cast<std::uint32_t>(random * count), last);
  if (random < kAlikeShare) return std::min(static_cast<std::uint32_t>(random / kAlikeShare * count), last);
  const float place = (random - kAlikeShare) / (1.0f - kAlikeShare) * all;
  if (place < distant || !(importance > 0.0f)) {
    const auto after = std::ranges::upper_bound(cumulative_, std::min(place, distant));
    const auto most = static_cast<std::ptrdiff_t>(cumulative_.size()) - 1;
    return distant_lights_[static_cast<std::size_t>(std::min(after - cumulative_.begin(), most))];
  }
  return placed_lights_[tree_.pick((place - distant) / importance, point, normal, visibility_.at(point))
                            .light];
}

LightPick LightSampler::pick(std::uint32_t which, float random, const Vec3f& point,
                             const Vec3f& normal) const {
  if (!by_chance()) return lights_[which];
  const auto picks = static_cast<float>(picks_);
  const float importance = this->importance(point, normal);
  const std::uint32_t light = found((static_cast<float>(which) + random) / picks, importance, point, normal);
  LightPick pick = lights_[light];
  pick.expected = chance(light, importance, point, normal) * picks;
  return pick;
}

Vec3f LightSampler::image_domes_radiance(const Vec3f& direction, float time) const {
  Vec3f sum;
  for (const LightPick& pick : lights_) {
    LightAlong along;
    if (!is_image_dome(*pick.light)) continue;
    if (find_light(*pick.light, {}, direction, time, along)) sum += along.radiance;
  }
  return sum;
}

Vec3f LightSampler::moving_dome_radiance(float time) const {
  Vec3f sum = still_dome_radiance_;
  for (const Light* dome : moving_domes_) sum += values_at(*dome, time).radiance;
  return sum;
}

}  // namespace msbvh
