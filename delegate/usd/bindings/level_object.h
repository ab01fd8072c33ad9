// A level of instancing on its way from Python to the translator: msbvh._core.InstanceLevel.
#pragma once

#include <nanobind/nanobind.h>

#include "delegate/translate/inputs.h"
#include "delegate/usd/bindings/arguments.h"

namespace msbvh::python {

// Python objects under the names of translate::InstanceLevel and translate::PointInstancerInput. Where
// `selected` is given it is a point instancer's arrays, else matrices.
struct LevelObject {
  nanobind::object held;
  nanobind::object times01, matrices, breakpoints01, periods01;
  nanobind::object selected, path, count, positions, scales, orientations, orientations_name;
  nanobind::object velocities, accelerations, angular_velocities;
  nanobind::object frame01, seconds_per_shutter, velocity_scale;

  LevelObject();

  // What it borrows lives as long as `borrowed`, and `points`, where the arrays go, must as well. TypeError
  // or ValueError, naming the attribute, for what does not fit.
  translate::InstanceLevel input(Borrowed& borrowed, translate::PointInstancerInput& points) const;
};

}  // namespace msbvh::python
