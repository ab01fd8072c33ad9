// Rays that leave surfaces at scales from 1e-6 to 1e6. Off a convex body a ray to the upper side meets
// nothing more, whatever stands in the same place: what it meets is acne. Inside a closed surface each meets
// something: what gets out is a leak. Meshes, displaced grids, hair and points; still, moving, on curves,
// instanced.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "bench/moved_mesh.h"
#include "core/api/scene_trees.h"
#include "core/motion/affine_track.h"
#include "core/trace/oracle.h"
#include "tests/stability/shells.h"
#include "tests/stability/walker.h"
#include "tests/support/cages.h"
#include "tests/support/soak.h"

namespace msbvh {
namespace {
using procedural::Random;
using shells::in_parallel;
using shells::kPathsAtOnce;
using shells::Tally;

// Where a body is and how large, and on what tracks it moves.
struct Setting {
  TrackForm form;
  double scale = 1.0;
  Vec3d place{};

  // Shears and drifts, on a parabola where tracks can follow one: tracks are exact, straight stays straight.
  Vec3d at(const Vec3d& p, double u) const {
    const double bend = form.degree > 1 ? u * u : u, s = u - 0.5;
    const Vec3d sheared = p + Vec3d{0.3, -0.2, 0.1} * ((p.x + 2.0 * p.z) * s);
    return (sheared + Vec3d{0.8, 0.3, -0.5} * s + Vec3d{0, 0.4, 0} * bend) * scale + place;
  }
  TriangleMesh moved(bench::Pose pose) const {
    return bench::moved_mesh("body", std::move(pose), form,
                             [&](std::uint32_t, const Vec3d& p, double u) { return at(p, u); });
  }
  std::vector<RoundVertex> moved_round(std::vector<Vec3f> points, double radius) const {
    const std::size_t count = points.size() * form.controls();
    const TriangleMesh track = moved({std::move(points), {}});
    std::vector<RoundVertex> vertices;
    for (std::size_t i = 0; i < count; ++i)
      vertices.push_back({track.positions[i], static_cast<float>(radius * scale)});
    return vertices;
  }
};

bench::Pose octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

void add_octahedron(const Setting& setting, Scene& scene) {
  Mesh mesh;
  mesh.shape = setting.moved(octahedron());
  pictures::add(scene, std::move(mesh));
}

// Four in one place: corners in another order, triangles in another, and an instance that stays where it is.
void add_stacked(const Setting& setting, Scene& scene) {
  for (int copy = 0; copy < 3; ++copy) {
    bench::Pose pose = octahedron();
    for (Triangle& t : pose.triangles) std::rotate(t.begin(), t.begin() + copy, t.end());
    if (copy == 1) std::ranges::reverse(pose.triangles);
    Mesh mesh;
    mesh.shape = setting.moved(pose);
    pictures::add(scene, std::move(mesh));
  }
  Mesh shown;
  shown.shape = setting.moved(octahedron());
  pictures::add_instance(scene, std::move(shown), {Affine3f{}, Affine3f{}});
}

void add_ball(const Setting& setting, Scene& scene) {
  Points points;
  points.shape.segments = setting.form.segments;
  points.shape.degree = setting.form.degree;
  points.shape.point_count = 1;
  points.shape.vertices = setting.moved_round({{0.2f, 0.1f, -0.1f}}, 0.7);
  validate(points.shape);
  scene.world.push_back(points_id(static_cast<std::uint32_t>(scene.points.size())));
  scene.points.push_back(std::move(points));
}

// A straight hair of two spans.
void add_hair(const Setting& setting, CurveShape shape, Scene& scene) {
  Curves curves;
  curves.shape.segments = setting.form.segments;
  curves.shape.degree = setting.form.degree;
  curves.shape.shape = shape;
  curves.shape.vertex_count = 7;
  curves.shape.spans = {0, 3};
  std::vector<Vec3f> line;
  for (int i = 0; i < 7; ++i) line.push_back(Vec3f{0.9f, 0.3f, 0.2f} * (static_cast<float>(i) / 3.0f - 1.0f));
  curves.shape.vertices = setting.moved_round(line, 0.02);
  scene.world.push_back(curves_id(static_cast<std::uint32_t>(scene.curves.size())));
  scene.curves.push_back(std::move(curves));
}

// What stands in the world becomes a prototype, shown once under a map that turns, stretches and moves.
void show_as_instance(const Setting& setting, Scene& scene) {
  scene.prototypes.push_back({"/prototype", std::exchange(scene.world, {}), {}});
  InstanceSet set;
  set.name = "/instance";
  set.segments = setting.form.segments;
  set.degree = setting.form.degree;
  for (std::uint32_t c = 0; c < setting.form.controls(); ++c) {
    const float u = setting.form.moving() ? float(c) / float(setting.form.controls() - 1) : 0.5f;
    const float s = static_cast<float>(setting.scale);
    set.world_from_prototype.push_back({Vec3f{0.8f, 0.6f * u, 0} * s, Vec3f{-0.5f * u, 0.9f, 0.1f} * s,
                                        Vec3f{0, 0.2f, 1.1f} * s,
                                        Vec3f(setting.place) + Vec3f{u, -0.4f, 0.3f * u} * s});
  }
  scene.instances.push_back(std::move(set));
}

struct Body {
  const char* name;
  void (*add)(const Setting&, Scene&);
  bool instanced = false;
};

const Body kBodies[] = {
    {"octahedron", add_octahedron},
    {"octahedra in one place", add_stacked},
    {"ball", add_ball},
    {"ribbon", [](const Setting& s, Scene& scene) { add_hair(s, CurveShape::kRibbon, scene); }},
    {"tube", [](const Setting& s, Scene& scene) { add_hair(s, CurveShape::kTube, scene); }},
    {"octahedron, instanced", add_octahedron, true},
    {"ball, instanced", add_ball, true},
    {"tube, instanced", [](const Setting& s, Scene& scene) { add_hair(s, CurveShape::kTube, scene); }, true},
};

// A scene with its trees.
class Stage {
 public:
  explicit Stage(Scene scene)
      : scene_(std::make_shared<Scene>(std::move(scene))), trees_(scene_, {}, nullptr), index_(*scene_) {}
  const Scene& scene() const { return *scene_; }
  const SceneIndex& index() const { return index_; }
  const Accel& accel() const { return trees_.world(); }

 private:
  std::shared_ptr<const Scene> scene_;
  SceneTrees trees_;
  SceneIndex index_;
};

Stage stage_of(const Body& body, const Setting& setting) {
  Scene scene;
  // An instance's map has the scale and the place.
  body.add(body.instanced ? Setting{setting.form, 1.0, {}} : setting, scene);
  if (body.instanced) show_as_instance(setting, scene);
  return Stage(std::move(scene));
}

// Somewhere on the centre line, in the centre, or on a face; in the world.
Vec3d place_on(const Scene& scene, float time, Random& random) {
  Vec3d p;
  if (!scene.curves.empty()) {
    const float u = random.uniform() * 6.0f;
    const auto first = static_cast<std::uint32_t>(std::min(u, 5.0f));
    const auto at = [&](std::uint32_t i) { return Vec3d(scene.curves[0].shape.vertex(i, time).p); };
    p = lerp(at(first), at(first + 1), double(u) - first);
  } else if (!scene.points.empty()) {
    const RoundVertex ball = scene.points[0].shape.vertex(0, time);
    p = Vec3d(ball.p) + Vec3d(random.direction() * ball.radius) * 0.999;
  } else {
    const TriangleMesh& mesh = scene.meshes[0].shape;
    const Triangle& t = mesh.triangles[random.next() % mesh.triangles.size()];
    const double a = random.uniform(), b = random.uniform() * (1.0 - a);
    const auto at = [&](int i) { return Vec3d(mesh.position(t[static_cast<std::size_t>(i)], time)); };
    p = at(0) * (1.0 - a - b) + at(1) * a + at(2) * b;
  }
  if (scene.instances.empty() || scene.world.size() > 0) return p;
  const InstanceSet& set = scene.instances[0];
  return Affine3d(evaluate(set.world_from_prototype, set.form(), time)).point(p);
}

// At a silhouette front and back of an octahedron are equally near, and rounding says which one was hit. What
// leaves a back does so into the body.
bool is_back(const Scene& scene, const SurfaceHit& surface, float time) {
  if (scene.meshes.empty()) return false;
  const TriangleMesh& mesh = scene.meshes[0].shape;
  Vec3d centre = (Vec3d(mesh.position(0, time)) + Vec3d(mesh.position(1, time))) * 0.5;
  if (scene.world.empty()) {
    const InstanceSet& set = scene.instances[0];
    centre = Affine3d(evaluate(set.world_from_prototype, set.form(), time)).point(centre);
  }
  return dot(Vec3d(surface.geometric_normal), Vec3d(surface.position) - centre) < 0.0;
}

struct Acne {
  std::uint64_t paths = 0, rays = 0, found = 0, hits = 0, ended = 0, backs = 0, wrong_backs = 0;
  Acne& operator+=(const Acne& b) {
    paths += b.paths;
    rays += b.rays;
    found += b.found;
    hits += b.hits;
    ended += b.ended;
    backs += b.backs;
    wrong_backs += b.wrong_backs;
    return *this;
  }
};

constexpr int kLeaving = 4;

// To the upper side: anywhere, or almost along the surface.
Vec3f upwards(const Vec3f& normal, bool grazing, Random& random) {
  Vec3f d = random.direction();
  const float height = dot(d, normal);
  if (!grazing) return height < 0.0f ? d + normal * (-2.0f * height) : d;
  return d + normal * (std::pow(10.0f, random.uniform(-6.0f, -1.0f)) - height);
}

void leave_body(const Stage& stage, double scale, Random& random, Acne& acne) {
  Ray ray;
  ray.time = random.next() % 8 == 0 ? 0.25f * static_cast<float>(random.next() % 5) : random.uniform();
  ray.dir = random.direction();
  const Vec3d target = place_on(stage.scene(), ray.time, random);
  ray.org = Vec3f(target - Vec3d(ray.dir) * (scale * random.uniform(2.5f, 6.0f)));
  Hit hit;
  ++acne.paths;
  if (!stage.accel().intersect(ray, hit)) return;
  ++acne.hits;
  SurfaceHit surface = surface_at(stage.scene(), stage.index().resolve(hit), hit, ray);
  if (is_back(stage.scene(), surface, ray.time)) {
    ++acne.backs;
    acne.wrong_backs += judge_intersection(stage.accel().bvh(), ray, hit).has_value();
    return;
  }
  if (!clear_origin({stage.index(), stage.accel().bvh()}, ray, surface.origin)) {
    ++acne.ended;
    return;
  }
  for (int i = 0; i < kLeaving; ++i) {
    const Vec3f direction = upwards(surface.geometric_normal, i % 2 == 0, random);
    if (!(dot(direction, surface.geometric_normal) > 0.0f)) continue;
    ++acne.rays;
    acne.found += stage.accel().occluded(leave(surface, direction, ray.time));
  }
}

const TrackForm kForms[] = {{0, 1}, {1, 1}, {8, 1}, {1, 2}, {2, 3}};
// In multiples of the scale. From the second one hair is only 300 steps of single precision wide.
constexpr double kPlaces[] = {0.0, 1e3};

Acne check_bodies(double scale, std::uint64_t paths) {
  Acne all;
  for (const Body& body : kBodies) {
    for (const TrackForm& form : kForms) {
      for (const double place : kPlaces) {
        CAPTURE(std::string(body.name));
        CAPTURE(form.segments);
        CAPTURE(form.degree);
        CAPTURE(place);
        const Setting setting{form, scale, Vec3d{place, -place, place} * scale};
        const Stage stage = stage_of(body, setting);
        const Acne acne = in_parallel<Acne>(paths, [&](std::size_t i) {
          Random random(i + 1);
          Acne found;
          for (std::uint64_t path = 0; path < kPathsAtOnce; ++path) leave_body(stage, scale, random, found);
          return found;
        });
        CHECK(acne.found == 0);
        CHECK(2 * acne.hits > acne.paths);
        CHECK(acne.wrong_backs == 0);  // the oracle finds a front no nearer
        CHECK(double(acne.backs) <= 1.0 + 1e-4 * double(acne.hits));
        all += acne;
      }
    }
  }
  return all;
}

// A closed displaced surface.
class GridTrap : public Stage {
 public:
  explicit GridTrap(const Setting& setting) : Stage(scene_of(setting)), setting_(setting) {}

  Ray first_ray(Random& random) const {
    Ray ray;
    ray.time = random.uniform();
    const Vec3f near = random.direction() * 0.1f;
    ray.org = Vec3f(setting_.at(Vec3d(near), double(ray.time)));
    ray.dir = random.direction();
    return ray;
  }
  Vec3f towards_edge(const Vec3f& origin, float time, Random& random) const {
    const GridMesh& mesh = scene().grids[0].shape;
    const GridTriangle t = mesh.triangle(random.next() % mesh.triangle_count());
    const auto v = vertices_of(t);
    const auto at = [&](std::size_t i) {
      return Vec3d(mesh.point(mesh.grids[t.grid], v[i].row, v[i].column, time));
    };
    const double beside = std::pow(10.0, double(random.uniform(-9.0f, -1.0f)));
    const Vec3d p = lerp(at(0), at(1), double(random.uniform()));
    return Vec3f(normalize(lerp(p, at(2), beside) - Vec3d(origin)));
  }

 private:
  static Scene scene_of(const Setting& setting) {
    const auto cage = procedural::moved(procedural::cube_cage(), setting.form,
                                        [&](const Vec3d& p, double u) { return setting.at(p, u); });
    const double scale = setting.scale;
    Grids grids;
    grids.shape =
        dice(cage, {.level = 3, .displacement = procedural::bumps(0.08 * scale, 0.6 * scale, setting.place)});
    Scene scene;
    scene.world.push_back(grids_id(0));
    scene.grids.push_back(std::move(grids));
    return scene;
  }

  Setting setting_;
};

template <class Trap>
Tally walk(const Trap& trap, std::uint64_t seed) {
  shells::Walker<Trap> walker(trap, 0.5f, seed);
  for (std::uint64_t path = 0; path < kPathsAtOnce; ++path) walker.walk();
  return walker.tally();
}

Tally check_displaced(double scale, std::uint64_t paths) {
  Tally all;
  for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{1, 1}, TrackForm{4, 1}}) {
    for (const double place : kPlaces) {
      CAPTURE(form.segments);
      CAPTURE(place);
      const GridTrap trap({form, scale, Vec3d{place, -place, place} * scale});
      const auto tally = in_parallel<Tally>(paths, [&](std::size_t i) { return walk(trap, i + 1); });
      CHECK(tally.escaped == 0);
      CHECK(tally.rays > 0);
      all += tally;
    }
  }
  return all;
}

// With edges that are concave from within, at any angle.
Tally check_concave(double scale, std::uint64_t paths) {
  using shells::Solid;
  const auto size = static_cast<float>(scale);
  Tally all;
  for (const Solid solid : {Solid::kStar, Solid::kTangle, Solid::kTetra}) {
    for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{2, 1}, TrackForm{1, 3}}) {
      for (const bool instanced : {false, true}) {
        if (solid == Solid::kTangle && instanced) continue;
        CAPTURE(int(solid));
        CAPTURE(form.segments);
        CAPTURE(instanced);
        const shells::Shell shell{.name = "concave",
                                  .solid = solid,
                                  .form = form,
                                  .scale = size,
                                  .place = instanced ? 0.0f : 100.0f * size,
                                  .instanced = instanced};
        const auto tally = in_parallel<Tally>(
            paths, [&](std::size_t i) { return walk(shells::Trap(shell, i + 1), i + 1000); });
        CHECK(tally.escaped == 0);
        all += tally;
      }
    }
  }
  return all;
}

// A hundred million paths whole: half of them off bodies.
void check_scale(double scale) {
  CAPTURE(scale);
  const std::uint64_t wanted = test::soak_count(300'000, 100'000'000);
  constexpr std::uint64_t kConvex = std::size(kBodies) * std::size(kForms) * std::size(kPlaces);
  const Acne acne = check_bodies(scale, wanted / 2 / kConvex);
  const Tally grids = check_displaced(scale, wanted / 4 / 6), shells = check_concave(scale, wanted / 4 / 15);
  std::ostringstream figure;
  figure << "scale " << scale << ": " << acne.paths << " paths to convex bodies, " << acne.rays
         << " rays off them, " << acne.found << " met something, " << acne.backs
         << " hits on a silhouette's back, " << acne.ended << " hits had no origin; " << grids.rays
         << " rays in displaced grids and " << shells.rays << " in concave shells, "
         << grids.escaped + shells.escaped << " escaped, " << grids.ended + shells.ended << " of "
         << grids.bounces + shells.bounces << " bounces ended";
  test::soak_figure("secondary rays", figure.str());
  if (std::getenv("MSBVH_TEST_FIGURES")) MESSAGE(figure.str());
}

TEST_SUITE("slow") {
  TEST_CASE("soak: rays that leave surfaces at scale 1e-6") { check_scale(1e-6); }
  TEST_CASE("soak: rays that leave surfaces at scale 1e-3") { check_scale(1e-3); }
  TEST_CASE("soak: rays that leave surfaces at scale 1") { check_scale(1.0); }
  TEST_CASE("soak: rays that leave surfaces at scale 1e3") { check_scale(1e3); }
  TEST_CASE("soak: rays that leave surfaces at scale 1e6") { check_scale(1e6); }
}

}  // namespace
}  // namespace msbvh
