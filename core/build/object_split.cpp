#include "core/build/object_split.h"

#include <array>
#include <vector>

#include "core/base/parallel.h"

namespace msbvh {
namespace {

// Above this, a set is looked at in parallel, in chunks of this size.
constexpr std::size_t kChunk = 32768;

struct Bins {
  std::array<std::array<Box3f, ObjectBinning::kBins>, 3> box;
  std::array<std::array<std::uint32_t, ObjectBinning::kBins>, 3> count{};

  void add(std::span<const Reference> references, const ObjectBinning& binning) {
    for (const Reference& r : references) {
      for (int axis = 0; axis < 3; ++axis) {
        const int b = binning.bin(r.box, axis);
        box[axis][b].grow(r.box);
        ++count[axis][b];
      }
    }
  }
  void add(const Bins& other) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < ObjectBinning::kBins; ++b) {
        box[axis][b].grow(other.box[axis][b]);
        count[axis][b] += other.count[axis][b];
      }
    }
  }
};

// Reduces over fixed chunks, in order: the same result for any number of threads.
template <typename T, typename Add>
T reduce(std::span<const Reference> references, const Add& add) {
  std::vector<T> parts((references.size() + kChunk - 1) / kChunk);
  parallel_for_ranges(references.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    add(parts[begin / kChunk], references.subspan(begin, end - begin));
  });
  return parts.empty() ? T{} : [&] {
    T all = parts[0];
    for (std::size_t i = 1; i < parts.size(); ++i) all.add(parts[i]);
    return all;
  }();
}

struct SetBoundsSum : SetBounds {
  void add(const SetBoundsSum& other) {
    box.grow(other.box);
    centres.grow(other.centres);
  }
};

void sweep(const Bins& bins, int axis, ObjectSplit& best) {
  constexpr int kBins = ObjectBinning::kBins;
  std::array<Box3f, kBins> right_box;
  std::array<std::uint32_t, kBins> right_count{};
  Box3f box;
  std::uint32_t count = 0;
  for (int b = kBins - 1; b > 0; --b) {
    box.grow(bins.box[axis][b]);
    right_box[b] = box;
    right_count[b] = count += bins.count[axis][b];
  }
  box = {};
  count = 0;
  for (int b = 1; b < kBins; ++b) {
    box.grow(bins.box[axis][b - 1]);
    count += bins.count[axis][b - 1];
    if (count == 0 || right_count[b] == 0) continue;
    const float cost =
        half_area(box) * block_count(count) + half_area(right_box[b]) * block_count(right_count[b]);
    if (cost < best.cost) best = {cost, axis, b, box, right_box[b]};
  }
}

}  // namespace

SetBounds bounds_of(std::span<const Reference> references) {
  return reduce<SetBoundsSum>(references, [](SetBoundsSum& sum, std::span<const Reference> part) {
    for (const Reference& r : part) {
      sum.box.grow(r.box);
      sum.centres.grow(r.box.lo * 0.5f + r.box.hi * 0.5f);
    }
  });
}

ObjectBinning::ObjectBinning(const Box3f& centres) : lo(centres.lo) {
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = centres.hi[axis] - centres.lo[axis];
    scale[axis] = extent > 0.0f ? 0.9999f * static_cast<float>(kBins) / extent : 0.0f;
    if (!std::isfinite(scale[axis])) scale[axis] = 0.0f;  // denormal extent: as good as none
  }
}

ObjectSplit find_object_split(std::span<const Reference> references, const ObjectBinning& binning) {
  const Bins bins =
      reduce<Bins>(references, [&](Bins& sum, std::span<const Reference> part) { sum.add(part, binning); });
  ObjectSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (binning.scale[axis] > 0.0f) sweep(bins, axis, best);
  }
  return best;
}

}  // namespace msbvh
