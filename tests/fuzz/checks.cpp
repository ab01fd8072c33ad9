#include "tests/fuzz/checks.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bvh/bvh.h"
#include "core/trace/oracle.h"
#include "core/trace/tracer.h"
#include "tests/fuzz/outcome.h"

namespace msbvh::fuzz {
namespace {

// Between two points of the box; one of them at its border now and then, or the ray along an axis.
Ray fuzzed_ray(FuzzedData& data, const Box3f& box) {
  const auto place = [&] {
    Vec3f p;
    for (int axis = 0; axis < 3; ++axis) {
      const float w = float(data.unit());
      p[axis] = box.lo[axis] * (1.0f - w) + box.hi[axis] * w;
    }
    return p;
  };
  Ray ray;
  ray.org = place();
  ray.dir = place() - ray.org;
  if (data.coin()) ray.org = ray.org - ray.dir;
  if (data.rarely()) ray.dir[int(data.below(3))] = 0.0f;
  if (data.rarely()) ray.dir[int(data.below(3))] = data.real32();
  if (data.rarely()) ray.tnear = data.real32();
  if (data.rarely()) ray.tfar = data.real32();
  ray.time = float(data.unit());
  return ray;
}

std::string words(const Ray& ray) {
  char text[256];
  std::snprintf(text, sizeof text, "ray from %.9g %.9g %.9g along %.9g %.9g %.9g in %.9g to %.9g at %.9g",
                ray.org.x, ray.org.y, ray.org.z, ray.dir.x, ray.dir.y, ray.dir.z, ray.tnear, ray.tfar,
                ray.time);
  return text;
}

void judge(const Accel& accel, const Tracer& tracer, const Ray& ray) {
  Hit hit;
  const bool found = tracer.intersect(ray, hit);
  if (const auto wrong = judge_intersection(accel.bvh(), ray, found ? std::optional(hit) : std::nullopt)) {
    fail(words(ray) + ": " + *wrong);
  }
  if (const auto wrong = judge_occlusion(accel.bvh(), ray, tracer.occluded(ray))) {
    fail(words(ray) + ": occlusion: " + *wrong);
  }
}

void check_many(const Tracer& tracer, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  const auto occluded = std::make_unique<bool[]>(rays.size());
  tracer.intersect(rays, hits.data());
  tracer.occluded(rays, occluded.get());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    const bool found = tracer.intersect(rays[i], hit);
    if (found != hits[i].found() || (found && !(hit == hits[i])) || tracer.occluded(rays[i]) != occluded[i]) {
      fail(words(rays[i]) + ": another hit among many than alone");
    }
  }
}

}  // namespace

void check_tree(const Accel& accel, FuzzedData& data, std::uint32_t rays) {
  accel.verify();
  Box3f box;
  for (const Box3f& each : accel.bvh().root_bounds) box.grow(each);
  if (box.empty()) box = {{-1, -1, -1}, {1, 1, 1}};
  std::vector<Ray> all;
  for (std::uint32_t i = 0; i < rays; ++i) all.push_back(fuzzed_ray(data, box));
  const std::vector<InstructionSet> sets = supported_instruction_sets();
  const Tracer tracer(accel.bvh(), sets[data.below(std::uint32_t(sets.size()))]);
  for (const Ray& ray : all) judge(accel, tracer, ray);
  // A packet's worth of rays: each with others of its kind.
  std::vector<Ray> many;
  for (std::uint32_t i = 0; i < 24 && !all.empty(); ++i) many.push_back(all[(i / 8) % all.size()]);
  for (Ray& ray : many) ray.time = float(data.unit());
  check_many(tracer, many);
}

}  // namespace msbvh::fuzz
