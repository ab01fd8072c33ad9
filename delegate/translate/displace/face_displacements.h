// Which faces of a mesh are displaced, and by what.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/look/displacement.h"

namespace msbvh::translate {

using Displacements = std::span<const std::optional<Displacement>>;  // by material

class FaceDisplacements {
 public:
  // Borrows both. Nothing is displaced, with a warning, where a primvar that is needed has a value that is no
  // distance, or no texture coordinate.
  FaceDisplacements(const MeshInput& input, Displacements by_material, PrimLog& log);

  bool any() const { return !used_.empty(); }
  // Of the input's face; null: none.
  const Displacement* of_face(std::uint32_t face) const;
  // Those of its faces, each once.
  const std::vector<const Displacement*>& used() const { return used_; }
  // The one that the mesh brings along; null: none.
  const NamedPrimvar* primvar(const std::string& name) const;
  // Whether no distance changes within the shutter.
  bool is_still() const;
  // No point goes farther, in the object's units.
  double reach() const;

 private:
  const Displacement* of_material(std::int64_t material) const;
  bool check_primvars(PrimLog& log) const;

  const MeshInput& input_;
  Displacements by_material_;
  std::vector<const Displacement*> used_;
};

}  // namespace msbvh::translate
