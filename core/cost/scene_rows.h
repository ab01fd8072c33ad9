// Every geometry of a scene under one number: meshes, grids, curves, points, each list in the scene's order,
// as primId counts where no prim says otherwise.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/geometry/geometry_id.h"
#include "core/scene/scene.h"
#include "core/shade/scene_index.h"

namespace msbvh {

class SceneRows {
 public:
  // `scene` must outlive it.
  explicit SceneRows(const Scene& scene);

  std::uint32_t size() const { return first_.back(); }
  std::uint32_t row(GeometryId id) const { return first_[std::size_t(id.kind())] + id.index(); }
  std::uint32_t row(const HitSource& source) const;
  GeometryId id(std::uint32_t row) const;
  const std::string& name(std::uint32_t row) const;
  TrackForm form(std::uint32_t row) const;  // of its own motion

 private:
  const Scene* scene_;
  std::array<std::uint32_t, 5> first_{};  // by kind; then of all
};

}  // namespace msbvh
