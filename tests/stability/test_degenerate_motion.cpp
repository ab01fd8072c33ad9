// Motions at which interpolation degenerates, of vertices and of instances: triangles without area at one
// time and large at others, vertices that cross, keys that are equal or next to it, half and whole turns,
// maps that are singular at one time. Boxes are judged exactly, hits by the oracle, for every builder and
// layout.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include "bench/moved_mesh.h"
#include "core/motion/affine_track.h"
#include "tests/property/support.h"
#include "tests/stability/box_judge.h"
#include "tests/support/soak.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kTriangles = 40;

// A corner of a free triangle, all in double.
struct Corner {
  std::uint32_t triangle, index;
  std::array<Vec3d, 3> all;  // of the triangle
  TrackForm form;

  Vec3d here() const { return all[index]; }
  Vec3d middle() const { return (all[0] + all[1] + all[2]) * (1.0 / 3.0); }
  Vec3d about_middle(double scale) const { return middle() + (here() - middle()) * scale; }
  Vec3d heading() const {
    Random random(triangle + 77);
    return Vec3d(random.direction());
  }
  Vec3d turned(const Vec3d& axis, double radians, double u) const {
    return rotation(axis, radians)(here(), u - 0.5);
  }
};

struct VertexMotion {
  const char* name;
  Vec3d (*at)(const Corner&, double u);
  double radius = 1.0;      // of the triangles, in whose multiples rays start from them
  bool underflows = false;  // so small that hits are not claimed: docs/design/watertight.md, section 5
};

const VertexMotion kVertexMotions[] = {
    {"a point at the centre", [](const Corner& c, double u) { return c.about_middle(1.0 - 2.0 * u); }},
    {"a line at the centre",
     [](const Corner& c, double u) {
       const Vec3d foot = (c.all[0] + c.all[1]) * 0.5;
       return c.index == 2 ? foot + (c.here() - foot) * (1.0 - 2.0 * u) : c.here();
     }},
    {"an area at the centre alone",
     [](const Corner& c, double u) { return c.about_middle(4.0 * u * (1.0 - u)); }},
    {"an area at one end alone", [](const Corner& c, double u) { return c.about_middle(1.0 - u); }},
    {"never an area", [](const Corner& c, double u) { return c.all[0] * (1.0 + c.index) + c.heading() * u; }},
    {"vertices that cross",
     [](const Corner& c, double u) {
       return c.index == 2 ? c.here() : c.here() * (1.0 - u) + c.all[1 - c.index] * u;
     }},
    {"across the scene",
     [](const Corner& c, double u) { return c.here() + c.heading() * (1e3 * (u - 0.5)); }},
    {"far across the scene",
     [](const Corner& c, double u) { return c.here() + c.heading() * (1e6 * (u - 0.5)); }},
    {"equal keys", [](const Corner& c, double) { return c.here(); }},
    {"keys that are almost equal",
     [](const Corner& c, double u) { return c.here() * (1.0 + 0x1p-23 * std::sin(1e3 * u)); }},
    {"denormal in one coordinate",
     [](const Corner& c, double u) {
       const Vec3d p = c.here();
       return Vec3d{p.x, p.y, p.z * 1e-40 * (u - 0.3)};
     }},
    {"tiny",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 3}, 1.0, u) * 1e-10;
     },
     1e-10},
    {"huge",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 3}, 1.0, u) * 1e12;
     },
     1e12},
    {"so small that products underflow",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 3}, 1.0, u) * 1e-21;
     },
     1e-21, true},
    {"denormal keys",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 3}, 1.0, u) * 1e-39;
     },
     1e-39, true},
    {"half a turn",
     [](const Corner& c, double u) {
       return c.turned({0, 0, 1}, kPi, u);
     }},
    {"half a turn, askew",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 0.5}, kPi, u);
     }},
    {"a whole turn",
     [](const Corner& c, double u) {
       return c.turned({0, 0, 1}, 2.0 * kPi, u);
     }},
    {"nine whole turns",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 0.5}, 18.0 * kPi, u);
     }},
    {"next to the identity",
     [](const Corner& c, double u) {
       return c.turned({1, 2, 0.5}, 1e-7, u);
     }},
    // As often as there are keys, half as often, and as often as makes it seem slow.
    {"periodic",
     [](const Corner& c, double u) {
       const double keys = std::max(1u, c.form.segments);
       const double often[] = {keys, 0.5 * keys, keys + 1.0};
       return c.here() + c.heading() * (0.5 * std::sin(2.0 * kPi * often[c.triangle % 3] * u + 0.3));
     }},
};

TriangleMesh moved_freely(const VertexMotion& motion, const TrackForm& form, const Vec3d& at) {
  const TriangleMesh still = soup(kTriangles, 0.4f, 3);
  const auto corner = [&](std::uint32_t v) {
    const std::uint32_t first = v / 3 * 3;
    const auto& p = still.positions;
    return Corner{v / 3, v % 3, {Vec3d(p[first]), Vec3d(p[first + 1]), Vec3d(p[first + 2])}, form};
  };
  const bench::Pose pose{{still.positions.begin(), still.positions.begin() + still.vertex_count},
                         still.triangles};
  return bench::moved_mesh(motion.name, pose, form, [&](std::uint32_t v, const Vec3d&, double u) {
    return motion.at(corner(v), u) + at;
  });
}

// Linear parts, of an instance.
struct MapMotion {
  const char* name;
  Affine3d (*at)(double u);
  // Where maps are next to singular, the time from where their inverse is within what the oracle allows.
  double judged_from = 0.0;
};

Affine3d turn(const Vec3d& axis, double radians, double u) {
  const Motion motion = rotation(axis, radians);
  return {motion({1, 0, 0}, u), motion({0, 1, 0}, u), motion({0, 0, 1}, u), {}};
}
Affine3d stretch(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}, {}}; }

// With maps whose elements are 0 and +-1, one is interpolated without a rounding, however flat it is.
const MapMotion kMapMotions[] = {
    {"flat at the centre, then mirrored", [](double u) { return stretch(1, 1, 1 - 2 * u); }},
    {"a line at the centre", [](double u) { return stretch(1, 1 - 2 * u, 1 - 2 * u); }},
    {"a point at the centre", [](double u) { return stretch(1 - 2 * u, 1 - 2 * u, 1 - 2 * u); }},
    {"from a point", [](double u) { return stretch(u, u, u); }},
    {"to a plane", [](double u) { return stretch(1, 1 - u, 1); }},
    {"always flat", [](double u) { return stretch(1, u, 0); }},
    {"half a turn",
     [](double u) {
       return turn({0, 0, 1}, kPi, u);
     },
     0.06},
    {"half a turn, askew",
     [](double u) {
       return turn({1, 2, 0.5}, kPi, u);
     },
     0.06},
    {"a whole turn",
     [](double u) {
       return turn({0, 0, 1}, 2 * kPi, u);
     },
     0.06},
    {"a whole turn, askew",
     [](double u) {
       return turn({1, 2, 0.5}, 2 * kPi, u);
     },
     0.06},
    {"next to the identity",
     [](double u) {
       return turn({1, 2, 0.5}, 1e-7, u);
     }},
    {"a map that shears away",
     [](double u) {
       return Affine3d{{1, 0, 0}, {1e3 * u, 1, 0}, {0, 0, 1}, {}};
     }},
};

const TrackForm kForms[] = {{1, 1}, {2, 1}, {8, 1}, {128, 1}, {1, 2}, {4, 2}, {1, 3}, {2, 3}};

// A tree, and where in the world a point of one of its triangles is at a time.
struct Subject {
  Accel accel;
  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<Affine3f> maps;  // of the one instance, if it has one
  TrackForm form;              // of the maps, or of the mesh
  double radius = 1.0, judged_from = 0.0;
  bool judged = true;
  std::vector<std::shared_ptr<Accel>> objects{};

  Vec3d aim(Random& random, float time) const {
    const Triangle& t = mesh->triangles[random.next() % mesh->triangles.size()];
    const double a = random.uniform(), b = random.uniform() * (1.0 - a);
    const auto at = [&](int i) { return Vec3d(mesh->position(t[static_cast<std::size_t>(i)], time)); };
    const Vec3d p = at(0) * (1.0 - a - b) + at(1) * a + at(2) * b;
    return maps.empty() ? p : Affine3d(evaluate(maps, form, time)).point(p);
  }
  // Not as close to a time where the map is singular: there its inverse is nothing but rounding.
  bool is_judged(float time) const {
    if (judged_from == 0.0) return judged;
    const Affine3d map(evaluate(maps, form, time));
    return std::abs(map.determinant()) > judged_from;
  }
};

Subject subject_of(const VertexMotion& motion, const TrackForm& form, const Vec3d& at,
                   const BuildSettings& settings) {
  Subject subject{
      .accel = {}, .mesh = nullptr, .maps = {}, .form = form, .radius = motion.radius, .judged_from = 0.0};
  subject.judged = !motion.underflows;
  subject.mesh = std::make_shared<TriangleMesh>(moved_freely(motion, form, at));
  subject.accel.add_mesh(subject.mesh);
  subject.accel.commit(settings);
  return subject;
}

Subject subject_of(const MapMotion& motion, const TrackForm& form, const Vec3d& at,
                   const BuildSettings& settings) {
  Subject subject{.accel = {}, .mesh = nullptr, .maps = {}, .form = form, .judged_from = motion.judged_from};
  subject.mesh = std::make_shared<TriangleMesh>(validated(moved(soup(kTriangles, 0.4f, 3), 0, wave(0, 1))));
  for (std::uint32_t i = 0; i < form.controls(); ++i) {
    Affine3d map = motion.at(double(i) / (form.controls() - 1));
    map.t = at;
    subject.maps.push_back(Affine3f(map));
  }
  auto object = std::make_shared<Accel>();
  object->add_mesh(subject.mesh);
  object->commit(settings);
  subject.accel.add_instances(object, form, subject.maps);
  subject.accel.commit(settings);
  subject.objects.push_back(std::move(object));
  return subject;
}

std::vector<Ray> rays_at(const Subject& subject, int count, std::uint64_t seed) {
  Random random(seed);
  const std::vector<float> times = stability::hard_times(std::min(subject.form.segments, 8u), seed);
  std::vector<Ray> rays(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray& ray = rays[i];
    ray.time = i % 2 == 0 ? random.uniform() : times[random.next() % times.size()];
    ray.dir = random.direction();
    if (i % 16 == 3) ray.dir.y = 0.0f;
    const Vec3d target = subject.aim(random, ray.time);
    ray.org = Vec3f(target - Vec3d(ray.dir) * (subject.radius * random.uniform(0.1f, 3.0f)));
  }
  return rays;
}

struct Count {
  std::uint64_t rays = 0, hits = 0, trees = 0, comparisons = 0;
};

void check_hits(const Subject& subject, const std::vector<Ray>& rays, Count& count) {
  const Bvh& bvh = subject.accel.bvh();
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(std::string(instruction_set_name(set)));
    const Tracer tracer(bvh, set);
    for (const Ray& ray : rays) {
      if (!subject.is_judged(ray.time)) continue;
      Hit hit;
      const bool found = tracer.intersect(ray, hit);
      const auto wrong = judge_intersection(bvh, ray, found ? std::optional(hit) : std::nullopt);
      CAPTURE(ray.time);
      CHECK_MESSAGE(!wrong, wrong.value_or(""));
      const auto shadow = judge_occlusion(bvh, ray, tracer.occluded(ray));
      CHECK_MESSAGE(!shadow, shadow.value_or(""));
      ++count.rays;
      count.hits += found;
    }
    property::check_many(tracer, rays);
  }
}

void check_subject(const Subject& subject, int rays, std::uint64_t seed, Count& count) {
  ++count.trees;
  CHECK_NOTHROW(subject.accel.verify());
  const std::vector<float> times = stability::hard_times(std::min(subject.form.segments, 8u), seed);
  stability::BoxVerdict boxes = stability::judge_boxes(subject.accel.bvh(), times);
  for (const auto& object : subject.objects) boxes += stability::judge_boxes(object->bvh(), times);
  CAPTURE(boxes.first);
  CHECK(boxes.outside == 0);
  count.comparisons += boxes.comparisons;
  check_hits(subject, rays_at(subject, rays, seed), count);
}

// Every motion on every form at both places, by every builder in every layout; one in `stride` of those.
template <class Motion, std::size_t N>
Count check_motions(const Motion (&motions)[N], std::size_t stride, int rays) {
  Count count;
  std::size_t number = 0;
  for (const Motion& motion : motions) {
    for (const TrackForm& form : kForms) {
      for (const double offset : {0.0, 1e4}) {
        for (const BuilderName& builder : kBuilders) {
          for (const TreeLayoutName& layout : kTreeLayouts) {
            if (number++ % stride != 0) continue;
            CAPTURE(std::string(motion.name));
            CAPTURE(form.segments);
            CAPTURE(form.degree);
            CAPTURE(offset);
            CAPTURE(std::string(builder.name));
            CAPTURE(std::string(layout.name));
            BuildSettings settings;
            settings.builder = builder.builder;
            settings.layout = layout.layout;
            check_subject(subject_of(motion, form, {offset, -offset, 0.3 * offset}, settings), rays, number,
                          count);
          }
        }
      }
    }
  }
  CHECK(10 * count.hits > count.rays);  // the rays do test something
  return count;
}

void report(const char* check, const Count& count) {
  std::ostringstream figure;
  figure << count.rays << " rays in " << count.trees << " trees held against the oracle, " << count.hits
         << " hits; " << count.comparisons << " comparisons of boxes";
  test::soak_figure(check, figure.str());
  if (std::getenv("MSBVH_TEST_FIGURES")) MESSAGE(std::string(check), ": ", figure.str());
}

}  // namespace

TEST_SUITE("slow") {
  // The strides have no factor in common with the number of builders and layouts: each motion meets them all.
  TEST_CASE("soak: degenerate motion of vertices: boxes hold and hits are those of the oracle") {
    report("degenerate motion", check_motions(kVertexMotions, test::soak_count(3, 1),
                                              static_cast<int>(test::soak_count(24, 2000))));
  }
  TEST_CASE("soak: instances singular at one time, and turned half and whole: boxes hold, hits are right") {
    report("degenerate instances",
           check_motions(kMapMotions, test::soak_count(3, 1), static_cast<int>(test::soak_count(24, 2000))));
  }
}
