#include "core/build/spatial_split.h"

#include <array>
#include <cmath>
#include <vector>

#include "core/build/clip.h"
#include "core/build/grid_clip.h"
#include "core/build/reduce.h"

namespace msbvh {
namespace {

constexpr int kMaxBins = 16;
constexpr std::size_t kChunk =
    4096;  // walking through bins is expensive: smaller chunks than for object splits

float coordinate(const Vec3f& p, int axis) { return (&p.x)[axis]; }

int longest_axis(const Box3f& box) {
  const Vec3f e = box.extent();
  return e.x >= e.y && e.x >= e.z ? 0 : (e.y >= e.z ? 1 : 2);
}

// Planes between bins, equally spaced along an axis of a set's box.
struct Planes {
  int axis, bins;
  float lo, step, per_unit, last;

  Planes(const Box3f& box, int axis_, int bins_)
      : axis(axis_), bins(bins_), lo(coordinate(box.lo, axis)), last(static_cast<float>(bins - 1)) {
    const float extent = coordinate(box.hi, axis) - lo;
    step = extent / static_cast<float>(bins);
    per_unit = static_cast<float>(bins) / extent;
    // Planes closer than the coordinates' own spacing separate nothing: all is in bin 0 then.
    if (!(lo + step > lo) || !std::isfinite(per_unit)) per_unit = 0.0f;
  }
  float plane(int i) const { return lo + step * static_cast<float>(i); }
  int bin(float x) const { return static_cast<int>(std::min(std::max((x - lo) * per_unit, 0.0f), last)); }
};

// A triangle with its corners in order along an axis: where planes across the axis cut it.
class OrderedTriangle {
 public:
  OrderedTriangle(const __m128 (&corners)[3], int axis) {
    for (int i = 0; i < 3; ++i) {
      alignas(16) float p[4];
      _mm_store_ps(p, corners[i]);
      corner_[i] = corners[i];
      x_[i] = p[axis];
    }
    order(0, 1);
    order(1, 2);
    order(0, 1);
    slope_[0] = slope(0, 2);
    slope_[1] = slope(0, 1);
    slope_[2] = slope(1, 2);
  }
  float lo() const { return x_[0]; }
  float middle() const { return x_[1]; }
  float hi() const { return x_[2]; }
  __m128 middle_corner() const { return corner_[1]; }
  // Where the plane meets the longest edge and one of the others.
  Box4 section(float x) const {
    Box4 box;
    box.grow(along(0, slope_[0], x));
    box.grow(x < x_[1] ? along(0, slope_[1], x) : along(1, slope_[2], x));
    return box;
  }

 private:
  void order(int i, int j) {
    if (x_[i] <= x_[j]) return;
    std::swap(x_[i], x_[j]);
    std::swap(corner_[i], corner_[j]);
  }
  __m128 slope(int i, int j) const {
    const float length = x_[j] - x_[i];
    const float per_unit = length > 0.0f ? 1.0f / length : 0.0f;
    return _mm_mul_ps(_mm_sub_ps(corner_[j], corner_[i]), _mm_set1_ps(per_unit));
  }
  __m128 along(int from, __m128 slope, float x) const {
    return _mm_add_ps(corner_[from], _mm_mul_ps(slope, _mm_set1_ps(x - x_[from])));
  }

  __m128 corner_[3], slope_[3];
  float x_[3];
};

struct SpatialBins {
  std::array<Box4, kMaxBins> box;
  std::array<std::uint32_t, kMaxBins> enter{}, leave{};  // references that begin and that end in a bin

  void add(const SpatialBins& other) {
    for (int b = 0; b < kMaxBins; ++b) {
      box[b].grow(other.box[b]);
      enter[b] += other.enter[b];
      leave[b] += other.leave[b];
    }
  }
};

// The parts of a triangle between planes: their corners are its own, and where the planes cut its edges.
void add_parts(const std::array<const Vec3f*, 3>& corners, const Box3f& box, int first, int last,
               const Planes& planes, SpatialBins& bins) {
  const Box4 whole(box);
  const __m128 points[3] = {load4(corners[0]), load4(corners[1]), load4(corners[2])};
  const OrderedTriangle triangle(points, planes.axis);
  const float end = std::min(triangle.hi(), coordinate(box.hi, planes.axis));
  float x = std::max(triangle.lo(), coordinate(box.lo, planes.axis));
  Box4 section = triangle.section(x);
  for (int bin = first; bin <= last; ++bin) {
    const float next = bin == last ? end : planes.plane(bin + 1);
    Box4 part = section;
    section = triangle.section(next);
    part.grow(section);
    if (triangle.middle() > x && triangle.middle() < next) part.grow(triangle.middle_corner());
    part = intersect(part, whole);
    if (!part.empty()) bins.box[bin].grow(part);
    x = next;
  }
}

// The same of a patch: its quads' boxes, clipped to each bin. Wider than the triangles between the planes,
// and what the paper takes for displaced patches.
void add_parts(const CentrePatch& patch, const Box3f& box, const Planes& planes, SpatialBins& bins) {
  for (std::uint32_t quad = 0; quad < patch.quads(); ++quad) {
    const Box3f inside = intersect(patch.quad_box(quad), box);
    if (inside.empty()) continue;
    const int last = planes.bin(coordinate(inside.hi, planes.axis));
    for (int bin = planes.bin(coordinate(inside.lo, planes.axis)); bin <= last; ++bin) {
      Box3f part = inside;
      part.lo[planes.axis] = std::max(part.lo[planes.axis], planes.plane(bin));
      part.hi[planes.axis] = std::min(part.hi[planes.axis], planes.plane(bin + 1));
      if (!part.empty()) bins.box[bin].grow(Box4(part));
    }
  }
}

void add(const CentrePose& pose, const Reference& r, const Planes& planes, SpatialBins& bins) {
  float lo = coordinate(r.box.lo, planes.axis), hi = coordinate(r.box.hi, planes.axis);
  if (!r.may_be_cut()) lo = hi = lo * 0.5f + hi * 0.5f;
  const int first = planes.bin(lo), last = planes.bin(hi);
  ++bins.enter[first];
  ++bins.leave[last];
  if (first == last) {
    bins.box[first].grow(Box4(r.box));
  } else if (r.is_grid()) {
    add_parts(centre_patch(pose.primitives(), r), r.box, planes, bins);
  } else {
    add_parts(pose.corners(r), r.box, first, last, planes, bins);
  }
}

SpatialSplit sweep(const SpatialBins& bins, const Planes& planes) {
  SpatialSplit best;
  float right_cost[kMaxBins];
  Box4 right_box[kMaxBins];
  std::size_t right_count[kMaxBins];
  Box4 box;
  std::size_t count = 0;
  for (int b = planes.bins - 1; b > 0; --b) {
    box.grow(bins.box[b]);
    right_count[b] = count += bins.leave[b];
    right_box[b] = box;
    right_cost[b] = half_area(box) * block_count(count);
  }
  box = {};
  count = 0;
  for (int b = 1; b < planes.bins; ++b) {
    box.grow(bins.box[b - 1]);
    count += bins.enter[b - 1];
    if (count == 0 || right_count[b] == 0) continue;
    const float cost = half_area(box) * block_count(count) + right_cost[b];
    if (cost < best.cost)
      best = {cost, planes.axis, planes.plane(b), count, right_count[b], box.box(), right_box[b].box()};
  }
  return best;
}

bool is_cut(const Reference& r, const SpatialSplit& split) {
  return r.may_be_cut() && r.box.lo[split.axis] < split.plane && r.box.hi[split.axis] > split.plane;
}

// Whether the side of the reference's centre, grown to hold all of it, and the other side without it cost
// less than both with a part of it. Each side counts as it is with all that lie on both sides cut.
bool better_whole(const Reference& r, const SpatialSplit& split) {
  const auto left = static_cast<float>(split.left_count), right = static_cast<float>(split.right_count);
  const float left_area = half_area(split.left), right_area = half_area(split.right);
  const bool goes_left = r.box.lo[split.axis] + r.box.hi[split.axis] < 2.0f * split.plane;
  Box3f grown = goes_left ? split.left : split.right;
  grown.grow(r.box);
  const float whole = goes_left ? half_area(grown) * left + right_area * (right - 1.0f)
                                : left_area * (left - 1.0f) + half_area(grown) * right;
  return whole < left_area * left + right_area * right;
}

// False if all of it lies on one side, within the error of clipping.
bool cut(const CentrePose& pose, const SpatialSplit& split, Reference& r, Reference& right) {
  const CutBounds bounds =
      r.is_grid() ? cut_bounds(centre_patch(pose.primitives(), r), r.box, split.axis, split.plane)
                  : cut_bounds(pose.triangle(r), r.box, split.axis, split.plane);
  if (bounds.below.empty() || bounds.above.empty()) return false;
  r.owner |= Reference::kClippedFlag;
  right = r;
  r.box = bounds.below;
  right.box = bounds.above;
  return true;
}

}  // namespace

SpatialSplit find_spatial_split(const CentrePose& pose, std::span<const Reference> references,
                                const Box4& box, std::size_t stride) {
  const std::size_t looked_at = (references.size() + stride - 1) / stride;
  const int bin_count = looked_at < 2 * kMaxBins ? kMaxBins / 2 : kMaxBins;
  const Box3f limits = box.box();
  const Planes planes(limits, longest_axis(limits), bin_count);
  const SpatialBins bins = reduce_in_chunks<SpatialBins>(
      looked_at, kChunk, [] { return SpatialBins(); },
      [&](SpatialBins& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) add(pose, references[i * stride], planes, sum);
      },
      [](SpatialBins& sum, const SpatialBins& part) { sum.add(part); });
  return sweep(bins, planes);
}

std::size_t cut_references(const CentrePose& pose, std::span<Reference> references, std::size_t room,
                           const SpatialSplit& split) {
  Reference* const behind = references.data() + references.size();
  std::size_t count = 0;
  for (Reference& r : references) {
    if (count == room) break;
    if (is_cut(r, split) && !better_whole(r, split) && cut(pose, split, r, behind[count])) ++count;
  }
  return count;
}

}  // namespace msbvh
