// A primvar where it is read on a mesh before it is cut into triangles: at places of a cage's faces, or at
// the corners of polygons.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

class FacePrimvar {
 public:
  // As it is at a time. One that does not fit the mesh is left out, with a warning.
  static std::optional<FacePrimvar> at(const NamedPrimvar& named, double time01, const Tessellation& mesh,
                                       PrimLog& log);

  // One value for each point of a face's squares, one square after the other. `cage_face` of the refinement,
  // `face` of the input.
  void at_squares(std::uint32_t cage_face, std::uint32_t face, std::span<const SquareLattice> squares,
                  Vec3d* out) const;
  // Of polygons: `corner` is an index into faceVertexIndices.
  Vec3d at_corner(std::uint32_t face, std::uint32_t corner, std::uint32_t point) const;

 private:
  FacePrimvar(const Tessellation& mesh, Interpolation interpolation)
      : mesh_(&mesh), interpolation_(interpolation) {}

  const Tessellation* mesh_;
  Interpolation interpolation_;
  ValueKind kind_;             // of kVertex and kFaceVarying
  std::vector<Vec3f> values_;  // of faces, points, corners; on a refinement of the channel; or one
};

}  // namespace msbvh::translate
