// What makes the scene of each class: about so many triangles (or spans, or points), moving on `form`.
#pragma once

#include <cstdint>

#include "bench/scene_classes.h"

namespace msbvh::bench {

BenchScene hairball(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene fences(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene spinning_wheels(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene twist(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene subdiv(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene cloth(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene debris(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene ballistic(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene room(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene crowd(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene rods(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene displaced(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed);
BenchScene hair(std::uint32_t spans, const TrackForm& form, std::uint32_t seed);
BenchScene grass(std::uint32_t spans, const TrackForm& form, std::uint32_t seed);
BenchScene particles(std::uint32_t count, const TrackForm& form, std::uint32_t seed);

}  // namespace msbvh::bench
