#include "core/build/spatial_split.h"

#include <array>
#include <vector>

#include "core/base/lerp.h"
#include "core/base/parallel.h"
#include "core/build/clip.h"
#include "core/build/grid_clip.h"
#include "core/build/object_split.h"

namespace msbvh {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kChunk = 8192;  // cutting is dear: smaller chunks than for object splits

struct Bin {
  Box3f box;
  std::uint32_t enter = 0, leave = 0;  // references that begin and that end here
};

// The planes between the bins of one axis; identical for counting and for dividing.
class Planes {
 public:
  Planes(float lo, float hi)
      : lo_(lo), step_((hi - lo) / static_cast<float>(kBins)), per_unit_(1.0f / step_) {}
  float plane(int i) const { return lo_ + step_ * static_cast<float>(i); }
  int bin(float x) const {
    int b = std::clamp(static_cast<int>((x - lo_) * per_unit_), 0, kBins - 1);
    while (b > 0 && x < plane(b)) --b;
    while (b < kBins - 1 && x >= plane(b + 1)) ++b;
    return b;
  }
  // Planes closer than the coordinates' own spacing separate nothing.
  bool distinct(float hi) const {
    return plane(1) > lo_ && plane(kBins - 1) < hi && std::isfinite(per_unit_);
  }

 private:
  float lo_, step_, per_unit_;
};

// Boxes of a triangle's parts between the planes, by walking its edges: a part's corners are vertices and
// crossings of edges with planes. In single precision and not conservative, since it only weighs candidates.
std::array<Box3f, kBins> parts_between(const std::array<Vec3f, 3>& triangle, int axis, const Planes& planes) {
  std::array<Box3f, kBins> parts;
  for (int i = 0; i < 3; ++i) {
    Vec3f a = triangle[i], b = triangle[(i + 1) % 3];
    if (a[axis] > b[axis]) std::swap(a, b);
    const int first = planes.bin(a[axis]), last = planes.bin(b[axis]);
    parts[first].grow(a);
    parts[last].grow(b);
    const float per_unit = 1.0f / (b[axis] - a[axis]);
    for (int bin = first; bin < last; ++bin) {
      Vec3f crossing = lerp(a, b, std::clamp((planes.plane(bin + 1) - a[axis]) * per_unit, 0.0f, 1.0f));
      crossing[axis] = planes.plane(bin + 1);
      parts[bin].grow(crossing);
      parts[bin + 1].grow(crossing);
    }
  }
  return parts;
}

// The same of a patch: its quads' boxes, clipped to each bin. Wider than the triangles between the planes,
// and what the paper takes for displaced patches.
std::array<Box3f, kBins> parts_of_patch(const CentrePatch& patch, const Box3f& within, int axis,
                                        const Planes& planes) {
  std::array<Box3f, kBins> parts;
  for (std::uint32_t quad = 0; quad < patch.quads(); ++quad) {
    const Box3f box = intersect(patch.quad_box(quad), within);
    if (box.empty()) continue;
    const int first = planes.bin(box.lo[axis]), last = planes.bin(box.hi[axis]);
    for (int bin = first; bin <= last; ++bin) {
      Box3f part = box;
      part.lo[axis] = std::max(part.lo[axis], planes.plane(bin));
      part.hi[axis] = std::min(part.hi[axis], planes.plane(bin + 1));
      parts[bin].grow(part);
    }
  }
  return parts;
}

struct AxisBins {
  std::array<Bin, kBins> bins;

  void add(const Primitives& primitives, const Reference& r, int axis, const Planes& planes) {
    if (r.is_instance()) {
      Bin& bin = bins[planes.bin(r.box.lo[axis] * 0.5f + r.box.hi[axis] * 0.5f)];
      bin.box.grow(r.box);
      ++bin.enter;
      ++bin.leave;
      return;
    }
    const int first = planes.bin(r.box.lo[axis]), last = planes.bin(r.box.hi[axis]);
    ++bins[first].enter;
    ++bins[last].leave;
    if (first == last) return bins[first].box.grow(r.box);
    const std::array<Box3f, kBins> parts =
        r.is_grid() ? parts_of_patch(centre_patch(primitives, r), r.box, axis, planes)
                    : parts_between(centre_triangle<float>(primitives, r), axis, planes);
    for (int b = first; b <= last; ++b) {
      const Box3f part = intersect(parts[b], r.box);
      if (!part.empty()) bins[b].box.grow(part);
    }
  }
  void add(const AxisBins& other) {
    for (int b = 0; b < kBins; ++b) {
      bins[b].box.grow(other.bins[b].box);
      bins[b].enter += other.bins[b].enter;
      bins[b].leave += other.bins[b].leave;
    }
  }
};

AxisBins fill(const Primitives& primitives, std::span<const Reference> references, int axis,
              const Planes& planes) {
  std::vector<AxisBins> parts((references.size() + kChunk - 1) / kChunk);
  parallel_for_ranges(references.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      parts[begin / kChunk].add(primitives, references[i], axis, planes);
  });
  for (std::size_t i = 1; i < parts.size(); ++i) parts[0].add(parts[i]);
  return parts[0];
}

void sweep(const AxisBins& axis_bins, int axis, const Planes& planes, SpatialSplit& best) {
  std::array<Box3f, kBins> right_box;
  std::array<std::size_t, kBins> right_count{};
  Box3f box;
  std::size_t count = 0;
  for (int b = kBins - 1; b > 0; --b) {
    box.grow(axis_bins.bins[b].box);
    right_box[b] = box;
    right_count[b] = count += axis_bins.bins[b].leave;
  }
  box = {};
  count = 0;
  for (int b = 1; b < kBins; ++b) {
    box.grow(axis_bins.bins[b - 1].box);
    count += axis_bins.bins[b - 1].enter;
    if (count == 0 || right_count[b] == 0) continue;
    const float cost =
        half_area(box) * block_count(count) + half_area(right_box[b]) * block_count(right_count[b]);
    if (cost < best.cost) best = {cost, axis, planes.plane(b), box, right_box[b], count, right_count[b]};
  }
}

Reference part_of(const Primitives& primitives, const Reference& r, const SpatialSplit& split, bool below) {
  Reference part = r;
  part.owner |= Reference::kClippedFlag;
  part.box = r.is_grid() ? clipped_bounds(centre_patch(primitives, r), r.box, split.axis, split.plane, below)
                         : clipped_bounds(centre_triangle<double>(primitives, r), r.box, split.axis,
                                          split.plane, below);
  return part;
}

}  // namespace

SpatialSplit find_spatial_split(const Primitives& primitives, std::span<const Reference> references,
                                const Box3f& box) {
  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    const Planes planes(box.lo[axis], box.hi[axis]);
    if (!planes.distinct(box.hi[axis])) continue;
    sweep(fill(primitives, references, axis, planes), axis, planes, best);
  }
  return best;
}

DividedReference divide(const Primitives& primitives, const Reference& r, const SpatialSplit& split) {
  const float lo = r.box.lo[split.axis], hi = r.box.hi[split.axis];
  const bool uncut = r.is_instance() || lo >= split.plane || hi <= split.plane;
  if (uncut) {
    const bool left = (lo * 0.5f + hi * 0.5f) < split.plane;
    return {left, !left, r, r};
  }
  DividedReference d{true, true, part_of(primitives, r, split, true), part_of(primitives, r, split, false)};
  d.in_left = !d.left.box.empty();
  d.in_right = !d.right.box.empty();
  if (d.in_left && d.in_right) return d;
  // All of it lies on one side, within the error of clipping: it stays whole.
  return {d.in_left, !d.in_left, r, r};
}

}  // namespace msbvh
