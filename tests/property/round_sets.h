// Curves and points of the property tests: at random, in every form of motion.
#pragma once

#include <cstdint>

#include "tests/property/support.h"

namespace msbvh::property {

inline const TrackForm kForms[] = {{0, 1}, {1, 1}, {8, 1}, {1, 2}, {2, 3}};
inline const CurveShape kShapes[] = {CurveShape::kRibbon, CurveShape::kTube, CurveShape::kOriented};
inline const Builder kTrees[] = {Builder::kMsbvh, Builder::kMbvh, Builder::kSwept, Builder::kTimeSplit};

struct Look {
  const char* name;
  float step;    // from a control vertex to the next
  float radius;  // at most; some are 0 at one end
};
inline const Look kLooks[] = {{"hair", 0.2f, 0.03f}, {"ribbons", 0.3f, 0.15f}, {"knots", 0.6f, 0.3f}};

// In that shape. The normals of oriented ones are random.
CurveSet with_shape(CurveSet curves, CurveShape shape, std::uint64_t seed);
// Chains of one to four spans that wander about the unit ball.
CurveSet wandering(const Look& look, const TrackForm& form, int chains, const Vec3f& centre, float scale,
                   std::uint64_t seed);
// Chains of five spans whose vertices coincide in every way: at the ends of spans, in the middle, whole
// spans, two of them in a row, first and last ones. `looped`: the last vertex lies where the first does.
CurveSet coinciding(const TrackForm& form, bool looped, std::uint64_t seed);
// Points in the unit ball that drift; every seventh has no width.
PointSet scattered(const TrackForm& form, int count, float radius, const Vec3f& centre, float scale,
                   std::uint64_t seed);
// A straight span of radius 0.1 along x, from 0 to 3.
CurveSet stick();

// A tree of it alone.
Accel accel_of(CurveSet curves, Builder builder);
Accel accel_of(PointSet points, Builder builder);

}  // namespace msbvh::property
