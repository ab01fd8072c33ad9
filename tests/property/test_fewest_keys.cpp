// Nodes with as few keys as bound their children about as well: the same hits as with all of them, fewer
// bytes, hardly more nodes.
#include <utility>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;

namespace {

Accel built(std::vector<TriangleMesh> meshes, bool fewest_keys, std::uint32_t slices = 0) {
  Accel accel;
  for (TriangleMesh& m : meshes) accel.add_mesh(std::move(m));
  BuildSettings settings;
  settings.fewest_keys = fewest_keys;
  settings.time_slices = slices;
  accel.commit(settings);
  return accel;
}

double nodes_a_ray(const Accel& accel) {
  TraceCounts counts;
  Random random(3);
  for (int i = 0; i < 4000; ++i) {
    Hit hit;
    Tracer(accel.bvh()).intersect_counted(random_ray(random, {}, 2.0f), hit, counts);
  }
  return double(counts.nodes) / double(counts.rays);
}

}  // namespace

TEST_CASE("nodes with all keys, or the fewest, equal the oracle") {
  for (const bool fewest : {false, true}) {
    for (const std::uint32_t segments : {1u, 8u, 128u}) {
      for (const std::uint32_t slices : {1u, 4u}) {
        for (const double offset : {0.0, 1e4}) {
          CAPTURE(fewest);
          CAPTURE(segments);
          CAPTURE(slices);
          CAPTURE(offset);
          const Vec3d at{offset, -offset, offset};
          const Accel accel = built({moved(sticks(40, 1), segments, rotation({0, 1, 0.2}, 2.0), at),
                                     moved(soup(60, 0.4f, 5), 2, translation({0.5, 1, 0}), at)},
                                    fewest, slices);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, Vec3f(at), 3.0f, 60, 19);
        }
      }
    }
  }
}

TEST_CASE("curves keep their segments, whatever is asked") {
  const TriangleMesh mesh = moved(soup(200, 0.3f, 5), TrackForm{4, 2}, rotation({1, 2, 3}, 1.0));
  CHECK(built({mesh}, true, 1).statistics().node_bytes == built({mesh}, false, 1).statistics().node_bytes);
}

TEST_CASE("the fewest keys spare bytes and cost hardly any nodes") {
  const TriangleMesh mesh = moved(sphere(48), 32, rotation({0, 1, 0}, 1.0));
  const Accel fewest = built({mesh}, true), all = built({mesh}, false);
  const double with = nodes_a_ray(fewest), without = nodes_a_ray(all);
  MESSAGE("node bytes ", fewest.statistics().node_bytes, " against ", all.statistics().node_bytes,
          ", nodes a ray ", with, " against ", without);
  CHECK(2 * fewest.statistics().node_bytes < all.statistics().node_bytes);
  CHECK(with < 1.1 * without);
}
