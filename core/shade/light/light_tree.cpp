#include "core/shade/light/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr std::size_t kBins = 12;
// Cosine that light which leaves at a grazing angle counts with at least: a cone may hold more than the half
// sphere.
constexpr float kLeastLeaving = 0.05f;
// That a surface sees light by at least. Angles come by roots of 1 - cos^2, whose roundings make 3e-4 of
// them.
constexpr float kLeastCosine = 1e-3f;
constexpr float kMost = 1e30f;  // of an importance: two of them have a finite sum

float sine_of(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }

// Of the angle a less the angle b, or of 0 where b is larger.
float cos_of_rest(float cos_a, float cos_b) {
  return cos_a > cos_b ? 1.0f : cos_a * cos_b + sine_of(cos_a) * sine_of(cos_b);
}

float angle_of(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

// The smallest cone about both: pbrt, DirectionCone.
void unite_axes(const LightReach& a, const LightReach& b, LightReach& both) {
  const float around_a = angle_of(a.cos_around), around_b = angle_of(b.cos_around);
  const float apart = angle_of(dot(a.axis, b.axis));
  both.axis = around_a >= around_b ? a.axis : b.axis;
  both.cos_around = std::min(a.cos_around, b.cos_around);
  if (std::min(apart + std::min(around_a, around_b), kPi) <= std::max(around_a, around_b)) return;
  const float around = 0.5f * (around_a + apart + around_b);
  const Vec3f across = b.axis - a.axis * dot(a.axis, b.axis);
  if (around >= kPi || length(across) == 0.0f) {
    both.cos_around = -1.0f;
    return;
  }
  const float turn = around - around_a;
  both.axis = normalize(a.axis * std::cos(turn) + normalize(across) * std::sin(turn));
  both.cos_around = std::cos(around);
}

LightReach united(const LightReach& a, const LightReach& b) {
  if (a.box.empty()) return b;
  if (b.box.empty()) return a;
  LightReach both;
  both.box = a.box;
  both.box.grow(b.box);
  unite_axes(a, b, both);
  both.cos_beyond = std::min(a.cos_beyond, b.cos_beyond);
  both.power = a.power + b.power;
  return both;
}

// Power times the area and the solid angle that it is spread over: Conty Estevez and Kulla, section 4.4.
float cost(const LightReach& reach) {
  if (reach.box.empty()) return 0.0f;
  const float around = angle_of(reach.cos_around),
              beyond = std::min(around + angle_of(reach.cos_beyond), kPi);
  const float sine = sine_of(reach.cos_around);
  const float spread =
      2.0f * kPi * (1.0f - reach.cos_around) +
      0.5f * kPi *
          (2.0f * beyond * sine - std::cos(around - 2.0f * beyond) - 2.0f * around * sine + reach.cos_around);
  const Vec3f e = reach.box.extent();
  return reach.power * spread *
         (half_area(reach.box) + dot(e, e) * 1e-3f);  // lights in a line have an area too
}

float along(const Vec3f& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// Where to part lights: an axis, and how many of its bins are the first part; 0 where they cannot be parted.
struct Cut {
  int axis = 0;
  std::size_t bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

std::size_t bin_of(const LightReach& light, const Box3f& centers, int axis) {
  const float begin = along(centers.lo, axis), width = along(centers.extent(), axis);
  const float place = (along(light.box.center(), axis) - begin) / width * float(kBins);
  return std::min(static_cast<std::size_t>(std::max(place, 0.0f)), kBins - 1);
}

Cut best_cut(std::span<const std::uint32_t> order, const std::vector<LightReach>& lights,
             const Box3f& centers) {
  Cut best;
  const Vec3f extent = centers.extent();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(along(extent, axis) > 0.0f)) continue;
    std::array<LightReach, kBins> bins{};
    for (const std::uint32_t light : order) {
      LightReach& bin = bins[bin_of(lights[light], centers, axis)];
      bin = united(bin, lights[light]);
    }
    for (std::size_t cut = 1; cut < kBins; ++cut) {
      LightReach below, above;
      for (std::size_t i = 0; i < kBins; ++i)
        (i < cut ? below : above) = united(i < cut ? below : above, bins[i]);
      if (below.box.empty() || above.box.empty()) continue;
      const float found = cost(below) + cost(above);
      if (found < best.cost) best = {axis, cut, found};
    }
  }
  return best;
}

}  // namespace

float importance(const LightReach& reach, const Vec3f& point, const Vec3f& normal) {
  const Vec3f half = reach.box.extent() * 0.5f, to_center = reach.box.center() - point;
  const bool either_side = normal == Vec3f{};
  const float above = dot(to_center, normal) + dot(half, abs(normal));
  if (!(above > 0.0f) && !either_side) return 0.0f;  // all of the box is below the horizon
  const float radius_squared = dot(half, half), distance_squared = dot(to_center, to_center);
  if (!(distance_squared > radius_squared))
    return std::min(radius_squared > 0.0f ? reach.power / radius_squared : reach.power, kMost);
  const Vec3f direction = to_center * (1.0f / std::sqrt(distance_squared));
  const float cos_box = std::sqrt(std::max(0.0f, 1.0f - radius_squared / distance_squared));
  // What is above the horizon is not left out by the roundings of an angle.
  const float facing =
      either_side ? 1.0f : std::max(cos_of_rest(dot(direction, normal), cos_box), kLeastCosine);
  const float off_normals = cos_of_rest(-dot(direction, reach.axis), reach.cos_around);
  const float leaving = cos_of_rest(off_normals, cos_box);
  if (!(leaving > reach.cos_beyond - kLeastCosine)) return 0.0f;
  return std::min(reach.power * facing * std::max(leaving, kLeastLeaving) / distance_squared, kMost);
}

LightTree::LightTree(const std::vector<LightReach>& lights) : leaf_of_(lights.size()) {
  if (lights.empty()) return;
  std::vector<std::uint32_t> order(lights.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  nodes_.reserve(2 * lights.size());
  build(order, 0, order.size(), lights);
}

std::uint32_t LightTree::build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                               const std::vector<LightReach>& lights) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin == 1) {
    nodes_[index].reach = lights[order[begin]];
    nodes_[index].light = order[begin];
    leaf_of_[order[begin]] = index;
    return index;
  }
  const std::span<std::uint32_t> part(order.data() + begin, end - begin);
  Box3f centers;
  for (const std::uint32_t light : part) centers.grow(lights[light].box.center());
  const Cut cut = best_cut(part, lights, centers);
  std::size_t middle = begin + part.size() / 2;  // lights in one place
  if (cut.bin > 0) {
    const auto below = [&](std::uint32_t light) {
      return bin_of(lights[light], centers, cut.axis) < cut.bin;
    };
    middle = begin + std::size_t(std::stable_partition(part.begin(), part.end(), below) - part.begin());
  }
  const std::uint32_t first = build(order, begin, middle, lights), second = build(order, middle, end, lights);
  nodes_[index].second = second;
  nodes_[index].reach = united(nodes_[first].reach, nodes_[second].reach);
  return index;
}

float LightTree::importance(const Vec3f& point, const Vec3f& normal) const {
  return nodes_.empty() ? 0.0f : msbvh::importance(nodes_[0].reach, point, normal);
}

// Half where neither has any importance: what bounds both saw more than either.
float LightTree::first_share(const Node& node, const Vec3f& point, const Vec3f& normal,
                             const std::uint8_t* seen) const {
  float first = msbvh::importance((&node + 1)->reach, point, normal);
  float second = msbvh::importance(nodes_[node.second].reach, point, normal);
  if (seen) {  // of at most 255: a sum is still finite
    first *= float(seen[&node + 1 - nodes_.data()]) * (1.0f / 255.0f);
    second *= float(seen[node.second]) * (1.0f / 255.0f);
  }
  return first + second > 0.0f ? first / (first + second) : 0.5f;
}

LightTree::Found LightTree::pick(float random, const Vec3f& point, const Vec3f& normal,
                                 const std::uint8_t* seen) const {
  float chance = 1.0f;
  std::uint32_t index = 0;
  while (nodes_[index].second != 0) {
    const float share = first_share(nodes_[index], point, normal, seen);
    const bool first = random < share;
    random = first ? random / share : (random - share) / (1.0f - share);
    random = std::min(random, 0x1.fffffep-1f);  // below 1, so that no share of 0 is taken
    chance *= first ? share : 1.0f - share;
    index = first ? index + 1 : nodes_[index].second;
  }
  return {nodes_[index].light, chance};
}

float LightTree::chance(std::uint32_t light, const Vec3f& point, const Vec3f& normal,
                        const std::uint8_t* seen) const {
  const std::uint32_t leaf = leaf_of_[light];
  float chance = 1.0f;
  std::uint32_t index = 0;
  while (nodes_[index].second != 0 && chance > 0.0f) {
    const float share = first_share(nodes_[index], point, normal, seen);
    const bool first = leaf < nodes_[index].second;
    chance *= first ? share : 1.0f - share;
    index = first ? index + 1 : nodes_[index].second;
  }
  return chance;
}

}  // namespace msbvh
