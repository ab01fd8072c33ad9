// Names in keyword arguments as the enumerations of delegate/translate/inputs.h. Each throws ValueError with
// what it found and what it expected.
#pragma once

#include <nanobind/nanobind.h>
#include <string>

#include "delegate/translate/inputs.h"

namespace msbvh::python {

[[noreturn]] inline void bad_choice(const char* name, const std::string& found, const char* expected) {
  throw nanobind::value_error(
      (std::string(name) + ": found \"" + found + "\"; expected " + expected).c_str());
}

inline Projection projection_from(const std::string& name) {
  if (name == "perspective") return Projection::kPerspective;
  if (name == "orthographic") return Projection::kOrthographic;
  bad_choice("projection", name, "perspective or orthographic");
}

inline translate::Normals computed_normals_from(const std::string& name) {
  if (name == "faceted") return translate::Normals::kFaceted;
  if (name == "smooth") return translate::Normals::kSmooth;
  bad_choice("computed_normals", name, "faceted or smooth");
}

inline LightKind light_kind_from(const std::string& name) {
  if (name == "distant") return LightKind::kDistant;
  if (name == "dome") return LightKind::kDome;
  if (name == "sphere") return LightKind::kSphere;
  if (name == "rect") return LightKind::kRect;
  if (name == "disk") return LightKind::kDisk;
  if (name == "cylinder") return LightKind::kCylinder;
  if (name == "camera") return LightKind::kCamera;
  if (name == "mesh") return LightKind::kMesh;
  bad_choice("kind", name, "distant, dome, sphere, rect, disk, cylinder, mesh or camera");
}

inline ImageMap image_map_from(const std::string& name) {
  if (name == "rect") return ImageMap::kRect;
  if (name == "latlong") return ImageMap::kLatlong;
  if (name == "angular") return ImageMap::kAngular;
  if (name == "mirroredBall") return ImageMap::kMirroredBall;
  bad_choice("map", name, "rect, latlong, angular or mirroredBall");
}

}  // namespace msbvh::python
