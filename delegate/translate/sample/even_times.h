// How densely what moves is evaluated where the density is fixed beforehand: cameras, lights, and a first
// look at where things are. What is sampled as densely as its motion asks for is sampler.h's.
#pragma once

#include <span>
#include <vector>

namespace msbvh::translate {

// 2^14 even intervals are the most that anything is sampled at; what turns still faster is a smear at any
// place.
inline constexpr int kMostEvenLevel = 14;
// Turns that are followed in that: eight times a turn.
inline constexpr double kMostTurnsFollowed = 2048.0;
// 2^7 intervals: the most segments that a track has.
inline constexpr int kFinestLevel = 7;
// How long before a jump its last old value is sampled: half of kJumpTime01 (value_track.h).
inline constexpr double kBeforeJump01 = 1e-6;
// Times that are nearer are one: an even one that differs from a breakpoint by rounding alone would make an
// interval of no length.
inline constexpr double kSameEvenTime01 = 1e-9;

// The power of two that makes at least so many even intervals, within reason.
int even_level(double intervals);

// 2^level even intervals of the shutter and the breakpoints inside, increasing from 0 to 1. Levels nest. With
// the breakpoints, motion that is linear between them is caught exactly; the even times catch curves. `held`:
// values jump at the breakpoints, so the instants before count too.
std::vector<double> even_times01(int level, std::span<const double> breakpoints01, bool held = false);

// What dense_times01() is for.
enum class Density {
  kCamera,  // cubics between samples stay within a millionth of the radius of a turn
  kLight,   // chords leave the circle of a turn by a thousandth of its radius
  kGlance,  // shows roughly where things are
};

// As many times as something needs that turns so often in the shutter.
std::vector<double> dense_times01(Density density, double turns, std::span<const double> breakpoints01,
                                  bool held);

}  // namespace msbvh::translate
