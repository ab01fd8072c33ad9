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
  std::uint64_t looked = 0;  // bounces whose neighbours were looked at

  Tally& operator+=(const Tally& b) {
    rays += b.rays;
    escaped += b.escaped;
    bounces += b.bounces;
    ended += b.ended;
    looked += b.looked;
    return *this;
  }
};

class Walker {
 public:
  Walker(const Trap& trap, float aimed, std::uint64_t seed) : trap_(trap), aimed_(aimed), random_(seed) {}

  void walk() {
    Ray ray = trap_.first_ray(random_);
    if (random_.uniform() < aimed_) ray.dir = trap_.towards_edge(ray.org, ray.time, random_);
    Hit hit;
    for (int depth = 0; depth < kBounces && meets(ray, hit); ++depth) {
      SurfacePoint surface = surface_at(trap_.scene(), trap_.index().resolve(hit), hit, ray);
      ++tally_.bounces;
      tally_.looked += surface.origin.beside_edge;
      if (!clear_origin({trap_.index(), trap_.accel().bvh()}, ray, surface.origin)) {
        ++tally_.ended;
        return;
      }
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

  Ray leaving(const SurfacePoint& surface, float time) {
    Vec3f direction = random_.direction();
    if (random_.uniform() < aimed_) direction = trap_.towards_edge(surface.position, time, random_);
    const float cosine = dot(direction, surface.geometric_normal);
    // To the upper side, by a mirror.
    if (cosine < 0.0f) direction += surface.geometric_normal * (-2.0f * cosine);
    if (dot(direction, surface.geometric_normal) < 0.0f) direction = surface.geometric_normal;
    return leave(surface, direction, time);
  }

  const Trap& trap_;
  const float aimed_;
  Random random_;
  Tally tally_;
};

constexpr std::uint64_t kPathsAShell = 256;  // then the next shell of the kind

// `aimed`: the share of the rays that head for an edge or a corner.
Tally walk_shells(const Shell& shell, float aimed, std::uint64_t paths) {
  const std::size_t count = (paths + kPathsAShell - 1) / kPathsAShell;
  std::vector<Tally> tallies(count);
  parallel_for(count, [&](std::size_t i) {
    const Trap trap(shell, i + 1);
    Walker walker(trap, aimed, i + 1000);
    for (std::uint64_t path = 0; path < kPathsAShell; ++path) walker.walk();
    tallies[i] = walker.tally();
  });
  Tally sum;
  for (const Tally& t : tallies) sum += t;
  return sum;
}

// What is allowed to end for want of a place to go on from, of all bounces: rays that run along a face next to its
// edge for a long way. Of those that are aimed at edges, and of those that are not.
constexpr double kMayEndAimed = 2e-3, kMayEnd = 1e-5;

Tally check_shells(float aimed, std::uint64_t rays) {
  constexpr std::uint64_t kRaysAPath = 1 + kBounces * (kProbes + 1);
  Tally all;
  for (const Shell& shell : kShells) {
    CAPTURE(std::string(shell.name));
    const Tally tally = walk_shells(shell, aimed, rays / std::size(kShells) / kRaysAPath + 1);
    CHECK(tally.escaped == 0);
    CHECK(double(tally.ended) <= (aimed > 0.0f ? kMayEndAimed : kMayEnd) * double(tally.bounces));
    CHECK(tally.looked > 0);
    if (std::getenv("MSBVH_TEST_FIGURES"))
      MESSAGE(std::string(shell.name), ": ", tally.rays, " rays, ", tally.escaped, " escaped; of ", tally.bounces,
              " bounces ", tally.looked, " looked at neighbours, ", tally.ended, " ended");
    all += tally;
  }
  return all;
}

TEST_SUITE("slow") {
  TEST_CASE("soak: no ray gets out of a closed shell") {
    Tally all = check_shells(0.5f, test::soak_count(1'000'000, 50'000'000));
    all += check_shells(0.0f, test::soak_count(1'000'000, 50'000'000));
    test::soak_figure("light leaks", std::to_string(all.rays) + " rays in closed shells, " +
                                         std::to_string(all.escaped) + " escaped; " +
                                         std::to_string(all.ended) + " of " + std::to_string(all.bounces) +
                                         " bounces ended");
  }
}

}  // namespace
}  // namespace msbvh
