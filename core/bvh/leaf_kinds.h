// Which kinds of geometry stand in a tree's leaves: kernels are compiled for sets of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace msbvh {

// The last is no leaf: kernels are compiled for compact trees as well (TreeLayout).
enum class LeafKind : std::uint8_t { kTriangles, kInstances, kGrids, kCurves, kPoints, kCompactTree };

// A set of them, which may be a template's argument.
struct LeafKinds {
  std::uint8_t bits = 0;

  constexpr LeafKinds() = default;
  constexpr LeafKinds(std::initializer_list<LeafKind> kinds) {
    for (const LeafKind kind : kinds) add(kind);
  }

  constexpr void add(LeafKind kind) { bits |= bit(kind); }
  constexpr void add(LeafKinds others) { bits |= others.bits; }
  constexpr LeafKinds without(LeafKind kind) const {
    LeafKinds rest = *this;
    rest.bits &= std::uint8_t(~bit(kind));
    return rest;
  }
  constexpr LeafKinds without(LeafKinds others) const {
    LeafKinds rest = *this;
    rest.bits &= std::uint8_t(~others.bits);
    return rest;
  }
  constexpr LeafKinds with(LeafKind kind) const {
    LeafKinds more = *this;
    more.add(kind);
    return more;
  }
  constexpr bool has(LeafKind kind) const { return (bits & bit(kind)) != 0; }
  constexpr bool contains(LeafKinds others) const { return (bits & others.bits) == others.bits; }
  constexpr bool operator==(const LeafKinds&) const = default;

 private:
  static constexpr std::uint8_t bit(LeafKind kind) { return std::uint8_t(1u << static_cast<unsigned>(kind)); }
};

// The sets that kernels are compiled for: of those that contain a tree's the first one serves it. What a tree
// does not hold costs no instruction; what is rare shares a kernel.
inline constexpr LeafKinds kTrianglesAlone = {LeafKind::kTriangles};
inline constexpr LeafKinds kKernelKinds[] = {
    kTrianglesAlone,
    {LeafKind::kTriangles, LeafKind::kInstances},
    {LeafKind::kTriangles, LeafKind::kInstances, LeafKind::kGrids, LeafKind::kCurves, LeafKind::kPoints},
};
inline constexpr std::size_t kKernelSets = sizeof(kKernelKinds) / sizeof(LeafKinds);

// Its number.
constexpr std::size_t kernel_set_for(LeafKinds kinds) {
  std::size_t set = 0;
  while (!kKernelKinds[set].contains(kinds)) ++set;
  return set;
}

}  // namespace msbvh
