#include "bench/stability_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "bench/shapes.h"
#include "core/base/error.h"

namespace msbvh::bench {
namespace {

using std::numbers::pi;

constexpr StabilityShape kShapes[] = {
    {"ball", "a closed ball of 960 triangles", true},
    {"dense", "a closed ball of 9024 triangles, in flight at position 10000 alone", true},
    {"fine",
     "a closed ball of 39600 triangles, in flight at position 10000 with 129 keys alone; rays in any "
     "direction"
     " at any time",
     false, StabilityProbe::kInsidePlain},
    {"shell", "a closed irregular shell of some 1000 triangles", true},
    {"cube", "a closed cube of some 300 triangles, its faces in planes of two axes", true},
    {"instances", "four instances of a deforming ball; what moves on the track is the instances", true},
    {"displaced", "a closed displaced torus: for us patches, for Embree their 7680 triangles", false},
    {"tubes", "nine bent tubes of two cubic spans each, for Embree round Bezier curves", true,
     StabilityProbe::kIntoRound},
    {"points", "27 spheres, for Embree sphere points", true, StabilityProbe::kIntoRound},
};

Vec3d turn(const Vec3d& p, double radians) { return turned(p, normalize(Vec3d{1.0, 2.0, 0.5}), radians); }

// Meridians of the ball: every other one goes towards the next one on one side, the others towards them. At
// a share of 1 they meet, and half of the triangles have no area.
constexpr double kMeridians = 32.0;
Vec3d paired(const Vec3d& p, double share) {
  const double around = std::atan2(p.y, p.x), from_axis = std::hypot(p.x, p.y);
  const double moved = around + share * (pi / kMeridians) * std::cos(0.5 * kMeridians * around);
  return {from_axis * std::cos(moved), from_axis * std::sin(moved), p.z};
}

double denormal_if_small(double x, double u) {
  return std::abs(x) < 0.1 ? std::copysign(1e-40 * (1.0 + u), x) : x;
}

constexpr StabilityMotion kMotions[] = {
    {"translation", "by 24 times its size",
     [](const Vec3d& p, double u) {
       return p + Vec3d{40.0, -25.0, 10.0} * (u - 0.5);
     }},
    {"flight", "by 24 times its size, turning by 2 radians",
     [](const Vec3d& p, double u) {
       return turn(p, 2.0 * (u - 0.5)) + Vec3d{40.0, -25.0, 10.0} * (u - 0.5);
     }},
    {"rotation", "by 2 radians", [](const Vec3d& p, double u) { return turn(p, 2.0 * (u - 0.5)); }},
    {"whole turn", "by 360 degrees: with two keys it stands still, with three it passes through a line",
     [](const Vec3d& p, double u) { return turn(p, 2.0 * pi * (u - 0.5)); }},
    {"shear", "back and forth, by up to twice its size",
     [](const Vec3d& p, double u) {
       const double slant = 2.0 * (u - 0.5) + std::sin(20.0 * u);
       return p + Vec3d{slant * p.z, 0.3 * slant * p.x, 0.0};
     }},
    {"inversion", "through zero volume, inside out",
     [](const Vec3d& p, double u) { return p * (1.0 - 2.0 * u); }},
    {"flat at the centre", "through a plane, inside out: an area from the side at all other times",
     [](const Vec3d& p, double u) {
       return Vec3d{p.x, p.y, p.z * (1.0 - 2.0 * u)};
     },
     true},
    {"from a point", "no area at the shutter's begin alone", [](const Vec3d& p, double u) { return p * u; },
     true},
    {"area at the centre", "no area at both ends alone; not with two keys",
     [](const Vec3d& p, double u) { return p * (4.0 * u * (1.0 - u)); }, true},
    {"slivers at the centre", "half of the triangles have no area at the centre alone: their vertices cross",
     [](const Vec3d& p, double u) { return paired(p, 2.0 * u); }, true},
    {"slivers at the ends", "half of the triangles have no area at both ends; with two keys at any time",
     [](const Vec3d& p, double u) { return paired(p, std::abs(2.0 * u - 1.0)); }, true},
    {"near-equal keys", "by a rounding or two back and forth",
     [](const Vec3d& p, double u) { return p * (1.0 + 0x1p-23 * std::sin(1e3 * u)); }, true},
    {"denormal keys", "small coordinates are denormal numbers that grow to twice their size",
     [](const Vec3d& p, double u) {
       return Vec3d{denormal_if_small(p.x, u), denormal_if_small(p.y, u), denormal_if_small(p.z, u)};
     },
     true},
};

constexpr StabilityPlace kOrigin{0.0, 1.0};
constexpr StabilityPlace kPlaces[] = {{0.0, 1e-6}, kOrigin,    {0.0, 1e6}, {1e2, 1.0},
                                      {1e4, 1.0},  {1e6, 1e2}, {1e7, 1e3}};
// Of what is tried at some places alone.
constexpr StabilityPlace kFewPlaces[] = {kOrigin, {1e2, 1.0}, {1e4, 1.0}, {1e7, 1e3}};
constexpr StabilityPlace kThreePlaces[] = {kOrigin, {1e2, 1.0}, {1e4, 1.0}};
constexpr double kDensePosition = 1e4;
constexpr TrackForm kForms[] = {{1, 1}, {2, 1}, {8, 1}, {16, 1}, {32, 1}, {128, 1}, {2, 2}, {2, 3}};

template <typename T>
const T& named(std::span<const T> all, const std::string& name, const char* what) {
  std::string known;
  for (const T& one : all) {
    if (name == one.name) return one;
    known += (known.empty() ? "" : ", ") + std::string(one.name);
  }
  throw Error("bench: found the " + std::string(what) + " \"" + name + "\"; expected one of " + known);
}

bool is_one_of(std::span<const StabilityPlace> places, const StabilityPlace& place) {
  return std::ranges::find(places, place) != places.end();
}

// Balls of many triangles: the same motion at the same place, or a run would take hours.
bool has_large(const StabilityCell& cell) {
  return cell.motion == "flight" && cell.place.position == kDensePosition &&
         (cell.shape == "dense" || cell.form == TrackForm{kMaxSegments, 1});
}

bool has_round(const StabilityCell& cell, bool degenerate) {
  constexpr std::string_view kTried[] = {"flight", "rotation", "shear", "inversion"};
  return !degenerate && std::ranges::find(kTried, cell.motion) != std::end(kTried) &&
         is_one_of(kFewPlaces, cell.place);
}

bool has_degenerate(const StabilityCell& cell) {
  const bool ball = cell.shape == "ball";
  if (!ball && cell.shape != "cube") return false;
  if (cell.motion.starts_with("slivers") && !ball) return false;
  if (cell.motion == "area at the centre" && cell.form == TrackForm{1, 1}) return false;
  if (cell.motion == "denormal keys") return ball && cell.place == kOrigin;
  return is_one_of(kThreePlaces, cell.place);
}

}  // namespace

std::span<const StabilityShape> stability_shapes() { return kShapes; }
std::span<const StabilityMotion> stability_motions() { return kMotions; }
const StabilityShape& stability_shape(const std::string& name) {
  return named(stability_shapes(), name, "shape");
}
const StabilityMotion& stability_motion(const std::string& name) {
  return named(stability_motions(), name, "motion");
}

bool is_measured(const StabilityCell& cell) {
  const StabilityShape& shape = stability_shape(cell.shape);
  const StabilityMotion& motion = stability_motion(cell.motion);
  if (!is_valid_form(cell.form) || (cell.form.degree > 1 && !shape.curved_tracks)) return false;
  if (cell.shape == "dense" || cell.shape == "fine") return has_large(cell);
  if (shape.probe == StabilityProbe::kIntoRound) return has_round(cell, motion.degenerate);
  return !motion.degenerate || has_degenerate(cell);
}

std::vector<StabilityCell> stability_cells() {
  std::vector<StabilityCell> cells;
  for (const StabilityShape& shape : kShapes) {
    for (const StabilityMotion& motion : kMotions) {
      for (const TrackForm& form : kForms) {
        for (const StabilityPlace& place : kPlaces) {
          const StabilityCell cell{shape.name, motion.name, form, place};
          if (is_measured(cell)) cells.push_back(cell);
        }
      }
    }
  }
  return cells;
}

}  // namespace msbvh::bench
