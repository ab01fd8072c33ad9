// InstanceLevel: a level's attributes, set one by one, to translate::InstanceLevel.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "delegate/usd/bindings/attributes.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/level_object.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

constexpr Attribute<LevelObject> kAttributes[] = {
    {"held", &LevelObject::held},
    {"times01", &LevelObject::times01},
    {"matrices", &LevelObject::matrices},
    {"breakpoints01", &LevelObject::breakpoints01},
    {"periods01", &LevelObject::periods01},
    {"selected", &LevelObject::selected},
    {"path", &LevelObject::path},
    {"count", &LevelObject::count},
    {"positions", &LevelObject::positions},
    {"scales", &LevelObject::scales},
    {"orientations", &LevelObject::orientations},
    {"orientations_name", &LevelObject::orientations_name},
    {"velocities", &LevelObject::velocities},
    {"accelerations", &LevelObject::accelerations},
    {"angular_velocities", &LevelObject::angular_velocities},
    {"frame01", &LevelObject::frame01},
    {"seconds_per_shutter", &LevelObject::seconds_per_shutter},
    {"velocity_scale", &LevelObject::velocity_scale},
};

const nb::object& needed(const nb::object& given, const char* name) {
  return required(given, "InstanceLevel", name);
}

std::vector<double> copied(std::span<const double> values) { return {values.begin(), values.end()}; }

void read_matrices(const LevelObject& object, Borrowed& borrowed, InstanceLevel& level) {
  level.times01 = copied(borrowed.doubles(needed(object.times01, "times01"), "times01"));
  level.matrices = elements<Matrix4d>(borrowed.keep(checked_array<double>(
      needed(object.matrices, "matrices"), "matrices", {level.times01.size(), kAnySize, 4, 4})));
  if (!object.breakpoints01.is_none()) {
    level.breakpoints01 = copied(borrowed.doubles(object.breakpoints01, "breakpoints01"));
  }
  level.periods01 = copied(borrowed.doubles(object.periods01, "periods01"));
}

void read_points(const LevelObject& object, Borrowed& borrowed, bool held, PointInstancerInput& points) {
  take(points.path, object.path, "path", "a str");
  points.count = value_from<std::uint64_t>(needed(object.count, "count"), "count", "an int");
  points.positions = borrowed.samples(object.positions, "positions", held);
  points.scales = borrowed.samples(object.scales, "scales", held);
  points.orientations = borrowed.quaternions(object.orientations, "orientations", held);
  take(points.orientations_name, object.orientations_name, "orientations_name", "a str");
  points.rates = {borrowed.samples(object.velocities, "velocities", held),
                  borrowed.samples(object.accelerations, "accelerations", held)};
  points.angular_velocities = borrowed.samples(object.angular_velocities, "angular_velocities", held);
  take(points.time_remap.frame01, object.frame01, "frame01", "a float");
  take(points.time_remap.seconds_per_shutter, object.seconds_per_shutter, "seconds_per_shutter", "a float");
  take(points.time_remap.velocity_scale, object.velocity_scale, "velocity_scale", "a float");
}

}  // namespace

LevelObject::LevelObject() { set_to_none(*this, kAttributes); }

InstanceLevel LevelObject::input(Borrowed& borrowed, PointInstancerInput& points) const {
  InstanceLevel level;
  take(level.held, held, "held", "a bool");
  if (selected.is_none()) {
    read_matrices(*this, borrowed, level);
    return level;
  }
  level.selected = borrowed.ints(selected, "selected");
  read_points(*this, borrowed, level.held, points);
  level.points = &points;
  return level;
}

void bind_level(nb::module_& m) { bind_attributes(m, "InstanceLevel", kAttributes); }

}  // namespace msbvh::python
