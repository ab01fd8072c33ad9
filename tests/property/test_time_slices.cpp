// Temporal splits: trees for equal slices of the shutter give the same hits, whether a slice holds many
// segments, is one, or is a part of one.
#include <utility>

#include "core/base/error.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;

namespace {

Accel sliced(std::vector<TriangleMesh> meshes, std::uint32_t slices) {
  BuildSettings settings;
  settings.time_slices = slices;
  return property::accel_of(std::move(meshes), settings);
}

}  // namespace

TEST_CASE("time slices equal the oracle, finer and coarser than the segments, far from the origin") {
  for (const std::uint32_t slices : {2u, 4u, 8u, 64u}) {
    for (const std::uint32_t segments : {1u, 2u, 8u, 128u}) {
      for (const double offset : {0.0, 1e4, 1e6}) {
        CAPTURE(slices);
        CAPTURE(segments);
        CAPTURE(offset);
        const Vec3d at{offset, -offset, offset};
        const Accel accel = sliced({moved(soup(60, 0.4f, 5), segments, rotation({0, 1, 0.2}, 2.0), at),
                                    moved(sticks(20, 1), 1, translation({1, 0.5, -2}), at)},
                                   slices);
        CHECK(accel.bvh().slice_roots.size() == slices);
        CHECK_NOTHROW(accel.verify());
        check_against_oracle(accel, Vec3f(at), 3.0f, 60, 11);
      }
    }
  }
}

TEST_CASE("curves are cut into slices of one segment at most") {
  const Accel accel = sliced({moved(soup(60, 0.4f, 5), TrackForm{8, 2}, rotation({0, 1, 0.2}, 2.0)),
                              moved(soup(30, 0.4f, 6), TrackForm{2, 3}, rotation({1, 1, 0.2}, 2.0))},
                             2);
  CHECK(accel.bvh().slice_roots.size() == 8);
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 200, 11);
}

TEST_CASE("the builder slices what moves incoherently at many keys, and nothing else") {
  const auto slices = [](std::vector<TriangleMesh> meshes) {
    return sliced(std::move(meshes), 0).bvh().slice_roots.size();
  };
  CHECK(slices({debris(2000, 16, 1.5f, 3)}) == kIncoherentSlices);
  CHECK(slices({debris(2000, 8, 1.5f, 3)}) == 0);
  CHECK(slices({moved(sphere(48), 16, rotation({0, 1, 0}, 1.0))}) == 0);
  CHECK(slices({moved(soup(3000, 0.05f, 5), 16, translation({3, 0, 0}))}) == 0);
}

TEST_CASE("a number of slices that does not nest with the segments is refused") {
  for (const std::uint32_t slices : {3u, 12u, 256u})
    CHECK_THROWS_AS(sliced({moved(grid(2), 1, translation({1, 0, 0}))}, slices), Error);
}
