// Degenerate sets at every key count, by every builder: they build in bounded time and memory, keep the
// invariants, and are traced like the oracle says.
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "tests/property/support.h"
#include "tests/support/soak.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;

namespace {

TriangleMesh copies(int count, std::vector<Vec3f> corners) {
  TriangleMesh mesh;
  mesh.name = "copies";
  mesh.vertex_count = 3;
  mesh.positions = std::move(corners);
  mesh.triangles.assign(static_cast<std::size_t>(count), {0, 1, 2});
  return mesh;
}

// Each has vertices of its own, all in the same place: nothing is shared in a block.
TriangleMesh piled(int count) {
  TriangleMesh mesh = soup(count, 0.3f, 3);
  for (std::size_t v = 3; v < mesh.vertex_count; ++v) mesh.positions[v] = mesh.positions[v % 3];
  return mesh;
}

// A grid on a skewed plane: no axis separates anything exactly, every box is fat.
TriangleMesh slanted(int side) {
  return moved(grid(side), 0, [](const Vec3d& p, double) { return Vec3d{p.x, 0.7 * p.x + 0.4 * p.z, p.z}; });
}

// Concentric: boxes that all hold the same centre, sizes in a geometric series.
TriangleMesh nested(int count) {
  TriangleMesh mesh = soup(count, 1.0f, 5);
  for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
    const float size = std::pow(0.995f, static_cast<float>(v / 3 % 4000));
    const float corners[3][3] = {{-1, 0, -1}, {1, 0.1f, -1}, {0, -0.1f, 1}};
    mesh.positions[v] = Vec3f{corners[v % 3][0], corners[v % 3][1], corners[v % 3][2]} * size;
  }
  return mesh;
}

struct Shape {
  const char* name;
  TriangleMesh (*make)(int triangles);
};

const Shape kShapes[] = {
    {"none",
     [](int) {
       return copies(0, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}});
     }},
    {"one",
     [](int) {
       return copies(1, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}});
     }},
    {"identical",
     [](int n) {
       return copies(n, {{-1, 0.2f, -1}, {1, 0, -1}, {0, 0, 1}});
     }},
    {"in one place, vertices apart", [](int n) { return piled(n); }},
    {"in one plane", [](int n) { return grid(static_cast<int>(std::sqrt(n / 2.0))); }},
    {"in a slanted plane", [](int n) { return slanted(static_cast<int>(std::sqrt(n / 2.0))); }},
    {"lines",
     [](int n) {
       return copies(n, {{-1, 0, -1}, {0, 0.5f, 0}, {1, 1, 1}});
     }},
    {"points",
     [](int n) {
       return copies(n, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
     }},
    {"nested", [](int n) { return nested(n); }},
};

constexpr std::uint32_t kSegments[] = {0, 1, 8, 128};

TriangleMesh set_of(const Shape& shape, int triangles, std::uint32_t segments) {
  return moved(shape.make(triangles), segments, translation({0.5, 0.25, -0.5}));
}

Accel built(TriangleMesh mesh, const BuildSettings& settings) {
  Accel accel;
  accel.add_mesh(std::move(mesh));
  accel.commit(settings);
  return accel;
}

BuildSettings settings_for(Builder builder, float budget = BuildSettings{}.spatial_split_budget) {
  BuildSettings settings;
  settings.builder = builder;
  settings.spatial_split_budget = budget;
  return settings;
}

// How many trees a builder makes of a mesh.
std::uint64_t trees(Builder builder, std::uint32_t segments) {
  return builder == Builder::kTimeSplit ? std::max(1u, segments) : 1;
}

std::uint64_t allowed(const Accel& accel, const BuildSettings& settings, std::uint32_t segments) {
  const std::uint64_t triangles = accel.statistics().triangles;
  const float share = settings.builder == Builder::kMsbvh ? settings.spatial_split_budget : 0.0f;
  return triangles * trees(settings.builder, segments) +
         static_cast<std::uint64_t>(share * static_cast<float>(triangles));
}

void check_traced(const Shape& shape, std::uint32_t segments, const BuildSettings& settings) {
  CAPTURE(std::string(shape.name));
  CAPTURE(segments);
  CAPTURE(static_cast<int>(settings.builder));
  const Accel accel = built(set_of(shape, 120, segments), settings);
  CHECK_NOTHROW(accel.verify());
  CHECK(accel.statistics().references <= allowed(accel, settings, segments));
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(accel.bvh(), set);
    Random random(9);
    std::vector<Ray> rays;
    for (int i = 0; i < 24; ++i) rays.push_back(random_ray(random, {}, 2.0f));
    property::check_many(tracer, rays);
    for (const Ray& ray : rays) {
      Hit hit;
      const bool found = tracer.intersect(ray, hit);
      const auto wrong = judge_intersection(accel.bvh(), ray, found ? std::optional(hit) : std::nullopt);
      CHECK_MESSAGE(!wrong, wrong.value_or(""));
      const auto shadow = judge_occlusion(accel.bvh(), ray, tracer.occluded(ray));
      CHECK_MESSAGE(!shadow, shadow.value_or(""));
    }
  }
}

// Seconds a primitive of each tree, with room for a loaded machine and for sanitizers: what is quadratic
// takes a hundred times as long.
constexpr double kSecondsATriangle = 40e-6, kSeconds = 0.5;

void check_bounded(const Shape& shape, int triangles, std::uint32_t segments, const BuildSettings& settings) {
  CAPTURE(std::string(shape.name));
  CAPTURE(segments);
  CAPTURE(static_cast<int>(settings.builder));
  TriangleMesh mesh = set_of(shape, triangles, segments);
  const auto begin = std::chrono::steady_clock::now();
  const Accel accel = built(std::move(mesh), settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::uint64_t references = allowed(accel, settings, segments);
  // More keys make each reference cost more, too.
  const double work = static_cast<double>(references) *
                      (segments > 1 && trees(settings.builder, segments) == 1 ? 1.0 + segments / 8.0 : 1.0);
  CHECK(seconds < kSeconds + kSecondsATriangle * work);
  const BvhStatistics& s = accel.statistics();
  CHECK(s.references <= references);
  // 8-wide nodes, 2 references a node at the very least, and a block each.
  const std::uint64_t keys = trees(settings.builder, segments) == 1 ? segments + 1 : 2;
  CHECK(s.node_bytes + s.leaf_bytes <= 4096 + references * (96 * keys + 320));
  if (std::getenv("MSBVH_TEST_FIGURES"))
    MESSAGE(shape.name, " segments ", segments, " builder ", int(settings.builder), " seconds ", seconds,
            " bytes/ref ",
            double(s.node_bytes + s.leaf_bytes) / double(std::max<std::uint64_t>(1, references)));
}

}  // namespace

TEST_CASE("a ray without a direction, or that is not a number, hits nothing, alone and beside others") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const std::uint32_t segments : {0u, 1u, 8u}) {
    const Accel accel = built(set_of(kShapes[0], 300, segments), {});
    for (const InstructionSet set : supported_instruction_sets()) {
      const Tracer tracer(accel.bvh(), set);
      Random random(11);
      std::vector<Ray> rays(64, random_ray(random, {}, 2.0f));  // all the same way: a packet's, too
      for (std::size_t i = 0; i < rays.size(); ++i) rays[i].time = random.uniform();
      rays[3].dir = {};
      rays[9].dir = {kNan, 1.0f, 0.0f};
      rays[17].dir.x = kInfinite;
      rays[33].org.y = kNan;
      rays[40].org.z = -kInfinite;
      std::vector<Hit> hits(rays.size());
      tracer.intersect(rays, hits.data());
      for (const std::size_t i : {3, 9, 17, 33, 40}) {
        Hit hit;
        CHECK(!tracer.intersect(rays[i], hit));
        CHECK(!tracer.occluded(rays[i]));
        CHECK(!hits[i].found());
      }
      property::check_as_one_by_one(tracer, rays);
    }
  }
}

TEST_CASE("degenerate sets equal the oracle at every key count, by every builder") {
  for (const Shape& shape : kShapes) {
    for (const std::uint32_t segments : kSegments) {
      for (const BuilderName& builder : kBuilders)
        check_traced(shape, segments, settings_for(builder.builder));
    }
  }
}

TEST_CASE("degenerate sets build in bounded time and memory") {
  for (const Shape& shape : kShapes) {
    for (const std::uint32_t segments : kSegments) {
      for (const BuilderName& builder : kBuilders) {
        const bool expensive = builder.builder == Builder::kTimeSplit && segments > 8;
        check_bounded(shape,
                      expensive      ? 200
                      : segments > 8 ? 2'000
                                     : 10'000,
                      segments, settings_for(builder.builder));
      }
    }
  }
}

TEST_CASE("the budget of spatial splits holds, whatever it is") {
  for (const float budget : {0.0f, 0.1f, 1.0f, 4.0f}) {
    CAPTURE(budget);
    const BuildSettings settings = settings_for(Builder::kMsbvh, budget);
    for (const std::uint32_t segments : {0u, 1u, 8u}) {
      const Accel accel = built(moved(sticks(300, 7), segments, rotation({0, 1, 0}, 0.3)), settings);
      CHECK(accel.statistics().references <= allowed(accel, settings, segments));
      if (budget >= 0.1f) CHECK(accel.statistics().references > accel.statistics().triangles);
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, {}, 3.0f, 60, 11);
    }
    for (const Shape& shape : kShapes) check_traced(shape, 1, settings);
  }
}

TEST_SUITE("slow") {
  TEST_CASE("soak: a million triangles in one place, at every key count, by every builder") {
    const auto count = static_cast<int>(test::soak_count(100'000, 1'000'000));
    for (const char* name : {"identical", "in one place, vertices apart", "nested"}) {
      for (const Shape& shape : kShapes) {
        if (std::string(shape.name) != name) continue;
        for (const std::uint32_t segments : kSegments) {
          for (const BuilderName& builder : kBuilders) {
            if (segments > 8 && (builder.builder == Builder::kTimeSplit || shape.make != kShapes[2].make))
              continue;
            check_bounded(shape, count, segments, settings_for(builder.builder));
          }
        }
      }
    }
  }
}
