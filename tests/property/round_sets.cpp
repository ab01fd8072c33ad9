#include "tests/property/round_sets.h"

#include <algorithm>
#include <utility>

using msbvh::procedural::Random;

namespace msbvh::property {

CurveSet with_shape(CurveSet curves, CurveShape shape, std::uint64_t seed) {
  curves.shape = shape;
  if (shape != CurveShape::kOriented) return curves;
  Random random(seed);
  for (std::size_t i = 0; i < curves.vertices.size(); ++i)
    curves.normals.push_back(random.direction() * random.uniform(0.5f, 2.0f));
  return curves;
}

CurveSet wandering(const Look& look, const TrackForm& form, int chains, const Vec3f& centre, float scale,
                   std::uint64_t seed) {
  CurveSet curves;
  curves.segments = form.segments;
  curves.degree = form.degree;
  Random random(seed);
  std::vector<std::vector<RoundVertex>> controls(form.controls());
  for (int chain = 0; chain < chains; ++chain) {
    const int spans = 1 + chain % 4;
    const auto first = static_cast<std::uint32_t>(controls[0].size());
    for (int s = 0; s < spans; ++s) curves.spans.push_back(first + 3 * static_cast<std::uint32_t>(s));
    Vec3f at = random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f});
    for (int i = 0; i <= 3 * spans; ++i) {
      const bool tip = chain % 3 == 0 && i == 3 * spans;
      for (std::vector<RoundVertex>& control : controls) {
        const Vec3f drift = random.direction() * (form.moving() ? 0.3f : 0.0f);
        const float radius = tip ? 0.0f : look.radius * random.uniform(0.3f, 1.0f);
        control.push_back({centre + (at + drift) * scale, radius * scale});
      }
      if (chain % 5 != 4 || i % 2 == 0) at = at + random.direction() * look.step;  // else vertices coincide
    }
  }
  curves.vertex_count = static_cast<std::uint32_t>(controls[0].size());
  for (const auto& control : controls)
    curves.vertices.insert(curves.vertices.end(), control.begin(), control.end());
  return curves;
}

PointSet scattered(const TrackForm& form, int count, float radius, const Vec3f& centre, float scale,
                   std::uint64_t seed) {
  PointSet points;
  points.segments = form.segments;
  points.degree = form.degree;
  points.point_count = static_cast<std::uint32_t>(count);
  Random random(seed);
  std::vector<Vec3f> start;
  for (int i = 0; i < count; ++i) start.push_back(random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f}));
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    for (int i = 0; i < count; ++i) {
      const Vec3f drift = random.direction() * (form.moving() ? 0.3f : 0.0f);
      const float r = i % 7 == 6 ? 0.0f : radius * random.uniform(0.1f, 1.0f);
      points.vertices.push_back({centre + (start[static_cast<std::size_t>(i)] + drift) * scale, r * scale});
    }
  }
  return points;
}

static BuildSettings settings_for(Builder builder) {
  BuildSettings settings;
  settings.builder = builder;
  return settings;
}

Accel accel_of(CurveSet curves, Builder builder) {
  Accel accel;
  accel.add_curves(std::move(curves));
  accel.commit(settings_for(builder));
  return accel;
}
Accel accel_of(PointSet points, Builder builder) {
  Accel accel;
  accel.add_points(std::move(points));
  accel.commit(settings_for(builder));
  return accel;
}

CurveSet stick() {
  CurveSet curves;
  curves.vertex_count = 4;
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) curves.vertices.push_back({{x, 0, 0}, 0.1f});
  curves.spans = {0};
  return curves;
}

CurveSet coinciding(const TrackForm& form, bool looped, std::uint64_t seed) {
  constexpr int kChains = 48, kSpans = 5, kVertices = 3 * kSpans + 1;
  CurveSet curves;
  curves.segments = form.segments;
  curves.degree = form.degree;
  Random random(seed);
  std::vector<std::vector<RoundVertex>> controls(form.controls());
  for (int chain = 0; chain < kChains; ++chain) {
    const auto first = static_cast<std::uint32_t>(controls[0].size());
    const auto span = static_cast<std::uint32_t>(curves.spans.size());
    for (std::uint32_t s = 0; s < kSpans; ++s) curves.spans.push_back(first + 3 * s);
    if (looped) curves.loops.push_back({span, span + kSpans - 1});
    std::vector<int> place(kVertices);  // which of the chain's places each vertex is at
    const int pattern = chain % 6, where = chain / 6 % kSpans;
    for (int i = 1; i < kVertices; ++i) {
      const int within = i - 3 * where;
      const bool same = pattern == 0   ? within == 1
                        : pattern == 1 ? within == 1 || within == 2
                        : pattern == 2 ? within >= 1 && within <= 3
                        : pattern == 3 ? within >= 1 && within <= 6
                        : pattern == 4 ? within == 3 || within == 4
                                       : i % 3 != 0;
      place[static_cast<std::size_t>(i)] = place[static_cast<std::size_t>(i - 1)] + (same ? 0 : 1);
    }
    std::vector<Vec3f> at = {random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f})};
    while (at.size() < kVertices) at.push_back(at.back() + random.direction() * 0.25f);
    for (std::vector<RoundVertex>& control : controls) {
      std::vector<Vec3f> drift;
      for (int i = 0; i < kVertices; ++i) drift.push_back(random.direction() * (form.moving() ? 0.2f : 0.0f));
      for (int i = 0; i < kVertices; ++i) {
        const bool back = looped && i == kVertices - 1;
        const auto p = static_cast<std::size_t>(back ? 0 : place[static_cast<std::size_t>(i)]);
        control.push_back({at[p] + drift[p], 0.12f * random.uniform(0.3f, 1.0f)});
      }
    }
  }
  curves.vertex_count = static_cast<std::uint32_t>(controls[0].size());
  for (const auto& control : controls)
    curves.vertices.insert(curves.vertices.end(), control.begin(), control.end());
  return curves;
}

}  // namespace msbvh::property
