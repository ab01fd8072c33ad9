// Trees with compact nodes have the hits that the oracle has, ray by ray, on every instruction set, and fewer
// bytes; whatever moves how, in slices, through refits and instances.
#include <utility>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

BuildSettings compact(std::uint32_t slices = 0) {
  BuildSettings settings;
  settings.layout = TreeLayout::kCompact;
  settings.time_slices = slices;
  return settings;
}

}  // namespace

TEST_CASE("compact nodes equal the oracle, whatever moves how") {
  for (const TrackForm form :
       {TrackForm{}, TrackForm{1, 1}, TrackForm{8, 1}, TrackForm{128, 1}, TrackForm{1, 2}, TrackForm{4, 3}}) {
    for (const double offset : {0.0, 1e4}) {
      CAPTURE(form.segments);
      CAPTURE(form.degree);
      CAPTURE(offset);
      const Vec3d at{offset, -offset, offset};
      const Accel accel = accel_of({moved(sticks(40, 1), form, rotation({0, 1, 0.2}, 2.0), at),
                                    moved(soup(60, 0.4f, 5), form, translation({0.5, 1, 0}), at)},
                                   compact());
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, Vec3f(at), 3.0f, 60, 19);
    }
  }
}

TEST_CASE("compact nodes among still ones, and in slices of the shutter") {
  for (const std::uint32_t slices : {1u, 4u}) {
    CAPTURE(slices);
    const Accel accel = accel_of({moved(soup(300, 0.3f, 5), TrackForm{}, translation({0, 0, 0}), {}),
                                  moved(soup(60, 0.4f, 6), TrackForm{4, 1}, rotation({1, 0, 0.2}, 2.0), {})},
                                 compact(slices));
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 3.0f, 100, 23);
  }
}

TEST_CASE("compact nodes take fewer bytes than full ones") {
  for (const std::uint32_t segments : {0u, 1u, 8u}) {
    CAPTURE(segments);
    const TriangleMesh mesh = moved(soup(4000, 0.1f, 5), segments, rotation({1, 2, 3}, 0.2), {});
    const BvhStatistics with = accel_of({mesh}, compact()).statistics();
    const BvhStatistics without = accel_of({mesh}, BuildSettings{}).statistics();
    CHECK(10 * with.node_bytes < 7 * without.node_bytes);
    CHECK(with.held_bytes() < without.held_bytes());
  }
}
