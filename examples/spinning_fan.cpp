// The accelerator on its own: a fan of three blades that turns by a third during the shutter, shot with rays
// at random times. By symmetry the blades cover the same share of every circle at any time; the picture shows
// the blur.
#include <cmath>
#include <cstdio>
#include <random>

#include "core/api/accel.h"

namespace {

// Three blades in the xy plane, with keys at i / 2^k of the shutter.
msbvh::TriangleMesh fan(std::uint32_t segments) {
  constexpr double kThirdOfATurn = 2.0943951023931953, kTurn = 0.8;
  msbvh::TriangleMesh mesh;
  mesh.name = "fan";
  mesh.segments = segments;
  mesh.vertex_count = 7;
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}};
  for (std::uint32_t key = 0; key <= segments; ++key) {
    mesh.positions.push_back({0, 0, 0});
    for (int tip = 0; tip < 6; ++tip) {
      const double turn = kThirdOfATurn * (tip / 2) + kTurn * key / segments + (tip % 2 ? 0.3 : -0.3);
      mesh.positions.push_back({float(std::cos(turn)), float(std::sin(turn)), 0});
    }
  }
  return mesh;
}

}  // namespace

int main() {
  msbvh::Accel accel;
  accel.add_mesh(fan(16));
  accel.commit();

  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  constexpr int kColumns = 60, kRows = 30, kSamples = 256;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      int hits = 0;
      for (int s = 0; s < kSamples; ++s) {
        const float px = 2.2f * (x + uniform(random)) / kColumns - 1.1f,
                    py = 1.1f - 2.2f * (y + uniform(random)) / kRows;
        msbvh::Hit hit;
        hits += accel.intersect({.org = {px, py, 1}, .dir = {0, 0, -1}, .time = uniform(random)}, hit);
      }
      std::putchar(" .:-=+*#%@"[hits * 9 / kSamples]);
    }
    std::putchar('\n');
  }
  const msbvh::BvhStatistics& s = accel.statistics();
  std::printf("%llu triangles, %llu references, %u segments\n", static_cast<unsigned long long>(s.triangles),
              static_cast<unsigned long long>(s.references), s.max_segments);
}
