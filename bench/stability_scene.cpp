#include "bench/stability_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
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

constexpr float kRoundRadius = 0.18f;  // of tubes and spheres in a box of 2 units
constexpr double kSwell = 0.3;         // by this share of it while the shutter is open

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
      : form_(cell.form), motion_(stability_motion(cell.motion)), place_(cell.place), random_(seed) {}

  std::shared_ptr<const Scene> make(const std::string& shape) {
    if (shape == "ball") return mesh(pose_of(procedural::sphere(16)));
    if (shape == "dense") return mesh(pose_of(procedural::sphere(48)));
    if (shape == "fine") return mesh(pose_of(procedural::sphere(100)));
    if (shape == "shell") return mesh(bumpy_sphere(1000, 0.25f, random_));
    if (shape == "cube") return mesh(cube_shell(300, 0.8f));
    if (shape == "instances") return instances();
    if (shape == "tubes") return tubes();
    if (shape == "points") return points();
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

  // Control-major; of centres at rest.
  std::vector<RoundVertex> round_vertices(const std::vector<Vec3d>& rest) const {
    std::vector<RoundVertex> vertices(std::size_t(form_.controls()) * rest.size());
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const auto centres = controls_of(form_, [&](double u) { return at(rest[v], u); });
      for (std::size_t c = 0; c < centres.size(); ++c) {
        const double open = double(c) / double(std::max<std::size_t>(1, centres.size() - 1));
        const auto radius = static_cast<float>(place_.scale * double(kRoundRadius) * (1.0 + kSwell * open));
        vertices[c * rest.size() + v] = {Vec3f(centres[c]), radius};
      }
    }
    return vertices;
  }

  // Side by side, each of two spans that bend.
  std::shared_ptr<const Scene> tubes() {
    CurveSet set;
    set.name = "tubes";
    set.segments = form_.segments;
    set.degree = form_.degree;
    set.shape = CurveShape::kTube;
    // Two spans of one parabola: no kink where they meet, which a swept circle would leave open.
    constexpr std::uint32_t kVertices = 7;
    constexpr double kParabola[kVertices] = {1.0, 1.0 / 3.0, 0.0, 0.0, 0.0, 1.0 / 3.0, 1.0};
    std::vector<Vec3d> rest;
    for (const double x : {-0.9, 0.0, 0.9}) {
      for (const double y : {-0.9, 0.0, 0.9}) {
        const Vec3d bend = Vec3d(random_.direction()) * 0.2;
        const auto first = static_cast<std::uint32_t>(rest.size());
        set.spans.insert(set.spans.end(), {first, first + kSpanVertices - 1});
        for (std::uint32_t i = 0; i < kVertices; ++i) {
          const double along = 2.0 * i / (kVertices - 1.0) - 1.0;
          rest.push_back(Vec3d{x, y, along} + bend * kParabola[i]);
        }
      }
    }
    set.vertex_count = static_cast<std::uint32_t>(rest.size());
    set.vertices = round_vertices(rest);
    auto scene = std::make_shared<Scene>();
    validate(set);
    scene->curves.emplace_back().shape = std::move(set);
    scene->world = {curves_id(0)};
    return scene;
  }

  std::shared_ptr<const Scene> points() {
    PointSet set;
    set.name = "points";
    set.segments = form_.segments;
    set.degree = form_.degree;
    std::vector<Vec3d> rest;
    for (const double x : {-0.9, 0.0, 0.9}) {
      for (const double y : {-0.9, 0.0, 0.9}) {
        for (const double z : {-0.9, 0.0, 0.9})
          rest.push_back(Vec3d{x, y, z} + Vec3d(random_.direction()) * 0.1);
      }
    }
    set.point_count = static_cast<std::uint32_t>(rest.size());
    set.vertices = round_vertices(rest);
    auto scene = std::make_shared<Scene>();
    validate(set);
    scene->points.emplace_back().shape = std::move(set);
    scene->world = {points_id(0)};
    return scene;
  }

  const TrackForm form_;
  const StabilityMotion& motion_;
  const StabilityPlace place_;
  procedural::Random random_;
};

}  // namespace

std::shared_ptr<const Scene> stability_scene(const StabilityCell& cell, std::uint32_t seed) {
  if (!is_measured(cell))
    throw Error("bench: " + cell.shape + ", " + cell.motion + ": found degree " +
                std::to_string(cell.form.degree) + ", " + std::to_string(cell.form.segments) +
                " segments; expected a motion that it can have");
  return Maker(cell, seed).make(cell.shape);
}

}  // namespace msbvh::bench
