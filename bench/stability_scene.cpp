#include "bench/stability_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "bench/limit_mesh.h"
#include "bench/moved_mesh.h"
#include "bench/procedural.h"
#include "bench/shapes.h"
#include "core/base/error.h"
#include "core/geometry/subdivision/dice.h"
#include "core/motion/bezier_fit.h"

namespace msbvh::bench {
namespace {

constexpr StabilityShape kShapes[] = {
    {"ball", "a closed ball of 960 triangles", true},
    {"dense", "a closed ball of 9024 triangles, in flight at position 10000 alone", true},
    {"shell", "a closed irregular shell of some 1000 triangles", true},
    {"cube", "a closed cube of some 300 triangles, its faces in planes of two axes", true},
    {"instances", "four instances of a deforming ball; what moves on the track is the instances", true},
    {"displaced", "a closed displaced torus: for us patches, for Embree their 7680 triangles", false},
};

Vec3d turn(const Vec3d& p, double radians) { return turned(p, normalize(Vec3d{1.0, 2.0, 0.5}), radians); }

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
     [](const Vec3d& p, double u) { return turn(p, 2.0 * std::numbers::pi * (u - 0.5)); }},
    {"shear", "back and forth, by up to twice its size",
     [](const Vec3d& p, double u) {
       const double slant = 2.0 * (u - 0.5) + std::sin(20.0 * u);
       return p + Vec3d{slant * p.z, 0.3 * slant * p.x, 0.0};
     }},
    {"inversion", "through zero volume, inside out",
     [](const Vec3d& p, double u) { return p * (1.0 - 2.0 * u); }},
};

constexpr StabilityPlace kPlaces[] = {{0.0, 1e-6}, {0.0, 1.0}, {0.0, 1e6}, {1e2, 1.0},
                                      {1e4, 1.0},  {1e6, 1e2}, {1e7, 1e3}};
constexpr double kDensePosition = 1e4;
constexpr TrackForm kForms[] = {{1, 1}, {8, 1}, {32, 1}, {128, 1}, {2, 2}, {2, 3}};

template <typename T>
const T& named(std::span<const T> all, const std::string& name, const char* what) {
  std::string known;
  for (const T& one : all) {
    if (name == one.name) return one;
    known += (known.empty() ? "" : ", ") + std::string(one.name);
  }
  throw Error("bench: found the " + std::string(what) + " \"" + name + "\"; expected one of " + known);
}

// The controls of a track that passes through at(u) at the keys and, for curves, at places between.
template <typename At>
std::vector<Vec3d> controls_of(const TrackForm& form, const At& at) {
  if (!form.moving()) return {at(0.5)};
  const auto nodes = fit_nodes(form.degree);
  std::vector<Vec3d> controls(form.controls());
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    Vec3d values[kMaxDegree + 1];
    for (std::uint32_t i = 0; i <= form.degree; ++i) values[i] = at((k + nodes[i]) / form.segments);
    controls_from_values([&](std::uint32_t i) -> Vec3d& { return values[i]; }, form.degree);
    for (std::uint32_t i = 0; i <= form.degree; ++i) controls[k * form.degree + i] = values[i];
  }
  return controls;
}

class Maker {
 public:
  Maker(const StabilityCell& cell, std::uint32_t seed)
      : form_(cell.form),
        motion_(named(stability_motions(), cell.motion, "motion")),
        place_(cell.place),
        random_(seed) {}

  std::shared_ptr<const Scene> make(const std::string& shape) {
    if (shape == "ball") return mesh(pose_of(procedural::sphere(16)));
    if (shape == "dense") return mesh(pose_of(procedural::sphere(48)));
    if (shape == "shell") return mesh(bumpy_sphere(1000, 0.25f, random_));
    if (shape == "cube") return mesh(cube_shell(300, 0.8f));
    if (shape == "instances") return instances();
    return displaced();
  }

 private:
  static Pose pose_of(TriangleMesh mesh) {
    mesh.positions.resize(mesh.vertex_count);
    return {std::move(mesh.positions), std::move(mesh.triangles)};
  }
  Vec3d placed(const Vec3d& p) const { return p * place_.scale + Vec3d{1.0, 1.0, -1.0} * place_.position; }
  Vec3d at(const Vec3d& p, double u) const { return placed(motion_.at(p, u)); }

  std::shared_ptr<const Scene> mesh(Pose pose) const {
    auto scene = std::make_shared<Scene>();
    const auto in_place = [&](std::uint32_t, const Vec3d& p, double u) { return at(p, u); };
    scene->meshes.emplace_back().shape = moved_mesh("shape", std::move(pose), form_, in_place);
    scene->world = {mesh_id(0)};
    return scene;
  }

  std::shared_ptr<const Scene> instances() const {
    auto scene = std::make_shared<Scene>();
    const auto swell = [](std::uint32_t, const Vec3d& p, double u) { return p * (0.8 + 0.3 * u); };
    scene->meshes.emplace_back().shape = moved_mesh("ball", pose_of(procedural::sphere(16)), {1, 1}, swell);
    scene->prototypes.push_back({.name = "ball", .geometry = {mesh_id(0)}});
    InstanceSet set;
    set.name = "balls";
    set.prototype = 0;
    set.segments = form_.segments;
    set.degree = form_.degree;
    for (const double x : {-1.2, 1.2}) {
      for (const double y : {-1.2, 1.2}) append_maps({x, y, 0.5 * x * y}, set);
    }
    scene->instances.push_back(std::move(set));
    return scene;
  }
  void append_maps(const Vec3d& offset, InstanceSet& set) const {
    const auto column = [&](const Vec3d& axis) {
      return controls_of(form_,
                         [&](double u) { return (motion_.at(axis, u) - motion_.at({}, u)) * place_.scale; });
    };
    const auto x = column({1, 0, 0}), y = column({0, 1, 0}), z = column({0, 0, 1});
    const auto t = controls_of(form_, [&](double u) { return placed(motion_.at({}, u) + offset); });
    for (std::size_t c = 0; c < t.size(); ++c)
      set.world_from_prototype.push_back(Affine3f(Affine3d{x[c], y[c], z[c], t[c]}));
  }

  std::shared_ptr<const Scene> displaced() {
    SubdivisionMesh cage = torus_cage({0, 1}, random_);
    const std::vector<Vec3f> rest = cage.positions;
    cage.segments = form_.segments;
    cage.positions.assign(std::size_t(form_.controls()) * cage.vertex_count, {});
    for (std::uint32_t v = 0; v < cage.vertex_count; ++v) {
      const auto controls = controls_of(form_, [&](double u) { return at(Vec3d(rest[v]), u); });
      for (std::size_t c = 0; c < controls.size(); ++c)
        cage.positions[c * cage.vertex_count + v] = Vec3f(controls[c]);
    }
    DiceSettings settings;
    settings.level = 2;
    settings.displacement = [scale = place_.scale](const SurfacePoint& point) {
      return 0.02 * scale * std::sin(7.0 * point.s + 3.0 * point.face) *
             std::sin(std::numbers::pi * point.s) * std::sin(std::numbers::pi * point.t);
    };
    auto scene = std::make_shared<Scene>();
    scene->grids.emplace_back().shape = dice(cage, settings);
    scene->world = {grids_id(0)};
    return scene;
  }

  const TrackForm form_;
  const StabilityMotion& motion_;
  const StabilityPlace place_;
  procedural::Random random_;
};

}  // namespace

std::span<const StabilityShape> stability_shapes() { return kShapes; }
std::span<const StabilityMotion> stability_motions() { return kMotions; }
std::span<const StabilityPlace> stability_places() { return kPlaces; }
std::span<const TrackForm> stability_forms() { return kForms; }

bool is_measured(const StabilityCell& cell) {
  const StabilityShape& shape = named(stability_shapes(), cell.shape, "shape");
  named(stability_motions(), cell.motion, "motion");
  const bool too_long =
      cell.shape == "dense" && (cell.motion != "flight" || cell.place.position != kDensePosition);
  return is_valid_form(cell.form) && !too_long && (cell.form.degree == 1 || shape.curved_tracks);
}

std::shared_ptr<const Scene> stability_scene(const StabilityCell& cell, std::uint32_t seed) {
  if (!is_measured(cell))
    throw Error("bench: " + cell.shape + ", " + cell.motion + ": found degree " +
                std::to_string(cell.form.degree) + ", " + std::to_string(cell.form.segments) +
                " segments; expected a motion that it can have");
  return Maker(cell, seed).make(cell.shape);
}

}  // namespace msbvh::bench
