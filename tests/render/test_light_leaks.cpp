// No ray that bounces about in a closed shell gets out of it: docs/design/watertight.md, section 4.
#include <atomic>
#include <string>

#include "core/base/parallel.h"
#include "tests/render/shells.h"
#include "tests/support/soak.h"

namespace msbvh {
namespace {
using namespace shells;

constexpr int kBounces = 4;  // of a path
constexpr int kProbes = 4;   // shadow rays from each place where it bounces

const Shell kShells[] = {
    {.name = "still"},
    {.name = "still, large", .rings = 12, .scale = 1e3f},
    {.name = "still, far from the origin", .place = 1e3f},
    {.name = "tetrahedra", .solid = Solid::kTetra},
    {.name = "tetrahedra, tiny", .solid = Solid::kTetra, .scale = 1e-4f},
    {.name = "crossing itself", .solid = Solid::kTangle},
    {.name = "2 keys", .form = {1, 1}},
    {.name = "9 keys, far", .form = {8, 1}, .scale = 10.0f, .place = 1e4f},
    {.name = "a cubic", .form = {1, 3}},
    {.name = "moving instance", .instanced = true},
    {.name = "moving instance of a moving mesh, far", .form = {2, 1}, .place = 1e3f, .instanced = true},
};

struct Tally {
  std::uint64_t rays = 0, escaped = 0, bounces = 0, ended = 0;  // ended: no place to go on from

  Tally& operator+=(const Tally& b) {
    rays += b.rays;
    escaped += b.escaped;
    bounces += b.bounces;
    ended += b.ended;
    return *this;
  }
};

class Walker {
 public:
  Walker(const Trap& trap, std::uint64_t seed) : trap_(trap), random_(seed) {}

  void walk() {
    Ray ray = trap_.first_ray(random_);
    Hit hit;
    for (int depth = 0; depth < kBounces && meets(ray, hit); ++depth) {
      const SurfacePoint surface =
          surface_at(trap_.scene(), trap_.index().resolve(hit), hit, ray);
      ++tally_.bounces;
      const float time = ray.time;
      for (int i = 0; i < kProbes; ++i) {
        ray = leaving(surface, time);
        ++tally_.rays;
        tally_.escaped += !trap_.accel().occluded(ray);
      }
    }
  }
  const Tally& tally() const { return tally_; }

 private:
  bool meets(const Ray& ray, Hit& hit) {
    ++tally_.rays;
    if (trap_.accel().intersect(ray, hit)) return true;
    ++tally_.escaped;
    return false;
  }

  // Half of them look for an edge, the others lie anywhere above the surface.
  Ray leaving(const SurfacePoint& surface, float time) {
    Vec3f direction = trap_.towards_edge(surface.position, time, random_);
    if (dot(direction, surface.geometric_normal) <= 0.0f || random_.uniform() < 0.5f) {
      direction = random_.direction();
      if (dot(direction, surface.geometric_normal) < 0.0f) direction = -direction;
    }
    return {.org = offset_origin(surface, direction), .dir = direction, .time = time};
  }

  const Trap& trap_;
  Random random_;
  Tally tally_;
};

constexpr std::uint64_t kPathsAShell = 256;  // then the next shell of the kind

Tally walk_shells(const Shell& shell, std::uint64_t paths) {
  const std::size_t count = (paths + kPathsAShell - 1) / kPathsAShell;
  std::vector<Tally> tallies(count);
  parallel_for(count, [&](std::size_t i) {
    const Trap trap(shell, i + 1);
    Walker walker(trap, i + 1000);
    for (std::uint64_t path = 0; path < kPathsAShell; ++path) walker.walk();
    tallies[i] = walker.tally();
  });
  Tally sum;
  for (const Tally& t : tallies) sum += t;
  return sum;
}

TEST_SUITE("slow") {
  TEST_CASE("soak: no ray gets out of a closed shell" * doctest::should_fail()) {
    constexpr std::uint64_t kRaysAPath = 1 + kBounces * (kProbes + 1);
    const std::uint64_t rays = test::soak_count(2'000'000, 100'000'000);
    Tally all;
    for (const Shell& shell : kShells) {
      CAPTURE(std::string(shell.name));
      const Tally tally = walk_shells(shell, rays / std::size(kShells) / kRaysAPath + 1);
      CHECK(tally.escaped == 0);
      CAPTURE(tally.ended);
      CHECK(tally.ended < tally.bounces / 1000);
      if (std::getenv("MSBVH_TEST_FIGURES"))
        MESSAGE(std::string(shell.name), ": ", tally.rays, " rays, ", tally.escaped, " escaped, ", tally.ended, " ended of ",
                tally.bounces);
      all += tally;
    }
    test::soak_figure("light leaks", std::to_string(all.rays) + " rays in closed shells, " +
                                         std::to_string(all.escaped) + " escaped, " +
                                         std::to_string(all.ended) + " of " + std::to_string(all.bounces) +
                                         " bounces ended");
  }
}

}  // namespace
}  // namespace msbvh
