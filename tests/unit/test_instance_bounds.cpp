// Boxes of moving instances of moving objects: at any time they enclose what is there then.
#include <doctest/doctest.h>
#include <optional>
#include <vector>

#include "bench/procedural.h"
#include "core/bvh/instance_bounds.h"
#include "core/trace/pose.h"

using namespace msbvh;
using procedural::Random;

namespace {

const TrackForm kForms[] = {{0, 1}, {1, 1}, {4, 1}, {1, 2}, {2, 3}};

std::vector<Affine3f> random_maps(Random& random, const TrackForm& form) {
  std::vector<Affine3f> maps;
  const auto vector = [&] { return random.in_box({-2, -2, -2}, {2, 2, 2}); };
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    const Vec3f x = vector(), y = vector(), z = vector();
    maps.push_back({x, y, z, vector()});
  }
  return maps;
}

std::vector<Box3f> random_boxes(Random& random, const TrackForm& form) {
  std::vector<Box3f> boxes;
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    Box3f box;
    box.grow(random.in_box({-1, -1, -1}, {1, 1, 1}));
    box.grow(random.in_box({-1, -1, -1}, {1, 1, 1}));
    boxes.push_back(box);
  }
  return boxes;
}

Vec3d in_double(const Vec3f& v) { return Vec3d(v); }

// At a time of the shutter; `local` is the track's.
Box3d box_at(const std::vector<Box3f>& boxes, const TrackForm& form, double local) {
  return {track_at(form, local, [&](std::uint32_t c) { return in_double(boxes[c].lo); }),
          track_at(form, local, [&](std::uint32_t c) { return in_double(boxes[c].hi); })};
}

struct Scene {
  TrackForm map_form, box_form;
  std::vector<Affine3f> maps;
  std::vector<Box3f> boxes;
  TimeRemap map_time{}, box_time{};

  // How many of the corners lie outside of the bounds, at dense times.
  int outside() const {
    const InstanceBounds bounds = bound_instance({maps, map_form, &map_time}, {boxes, box_form, &box_time});
    int count = 0;
    for (int i = 0; i <= 512; ++i) {
      const double u = i / 512.0;
      const std::optional<double> map_u = local_time(&map_time, u), box_u = local_time(&box_time, u);
      if (!map_u || !box_u) continue;
      const Box3d all = box_at(bounds.controls, bounds.form, u), own = box_at(boxes, box_form, *box_u);
      const Affine3d map = track_at(map_form, *map_u, [&](std::uint32_t c) { return Affine3d(maps[c]); });
      for (int k = 0; k < 8; ++k) {
        const Vec3d corner{k & 1 ? own.hi.x : own.lo.x, k & 2 ? own.hi.y : own.lo.y,
                           k & 4 ? own.hi.z : own.lo.z};
        count += !all.contains(map.point(corner));
      }
    }
    return count;
  }
};

Scene random_scene(Random& random, const TrackForm& map_form, const TrackForm& box_form) {
  return {map_form, box_form, random_maps(random, map_form), random_boxes(random, box_form)};
}

// A part of the track's time over the whole shutter, or hidden first and then two parts that follow each
// other.
TimeRemap random_remap(Random& random) {
  const float a = random.uniform(0.0f, 0.4f), b = random.uniform(0.4f, 0.9f), c = random.uniform(0.9f, 1.0f);
  if (random.next() % 2 == 0) return {{{0.0f, 0.0f, b, true}}};
  return {{{0.0f, 0.0f, 0.0f, false}, {a, 0.0f, b, true}, {b, b, c, true}}};
}

}  // namespace

TEST_CASE("an instance's box encloses it at any time, whatever moves") {
  Random random(1);
  for (const TrackForm& map_form : kForms) {
    for (const TrackForm& box_form : kForms) {
      CAPTURE(map_form.segments);
      CAPTURE(map_form.degree);
      CAPTURE(box_form.segments);
      CAPTURE(box_form.degree);
      for (int i = 0; i < 20; ++i) CHECK(random_scene(random, map_form, box_form).outside() == 0);
    }
  }
}

TEST_CASE("an instance's box encloses it at any time under time remaps") {
  Random random(2);
  for (const TrackForm& map_form : kForms) {
    for (const TrackForm& box_form : kForms) {
      CAPTURE(map_form.segments);
      CAPTURE(box_form.segments);
      for (int i = 0; i < 20; ++i) {
        Scene scene = random_scene(random, map_form, box_form);
        if (i % 3 != 0) scene.map_time = random_remap(random);
        if (i % 3 != 1) scene.box_time = random_remap(random);
        CHECK(scene.outside() == 0);
      }
    }
  }
}
