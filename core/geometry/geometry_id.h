// Which geometry: of what kind, and which of that kind.
#pragma once

#include <compare>
#include <cstdint>

namespace msbvh {

// Each kind is counted apart.
enum class GeometryKind : std::uint8_t {
  kTriangleMesh,  // core/geometry/triangle_mesh.h
  kGridMesh,      // core/geometry/grid_mesh.h
  kCurves,        // core/geometry/curve_set.h
  kPoints         // core/geometry/point_set.h
};

// 4 bytes: the kind in the upper 3 bits.
class GeometryId {
 public:
  static constexpr std::uint32_t kIndexBits = 29;

  constexpr GeometryId() = default;
  constexpr GeometryId(GeometryKind kind, std::uint32_t index)
      : bits_(static_cast<std::uint32_t>(kind) << kIndexBits | index) {}

  constexpr GeometryKind kind() const { return static_cast<GeometryKind>(bits_ >> kIndexBits); }
  constexpr std::uint32_t index() const { return bits_ & ((1u << kIndexBits) - 1u); }
  constexpr bool is(GeometryKind kind) const { return this->kind() == kind; }
  constexpr auto operator<=>(const GeometryId&) const = default;

 private:
  std::uint32_t bits_ = 0;
};

constexpr GeometryId mesh_id(std::uint32_t index) { return {GeometryKind::kTriangleMesh, index}; }
constexpr GeometryId grids_id(std::uint32_t index) { return {GeometryKind::kGridMesh, index}; }
constexpr GeometryId curves_id(std::uint32_t index) { return {GeometryKind::kCurves, index}; }
constexpr GeometryId points_id(std::uint32_t index) { return {GeometryKind::kPoints, index}; }

}  // namespace msbvh
