#include "core/build/spatial_split.h"

#include <array>
#include <vector>

#include "core/build/clip.h"
#include "core/build/reduce.h"

namespace msbvh {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kChunk = 4096;  // walking through bins is dear: smaller chunks than for object splits

// Planes between bins, equally spaced over the box of a set; one axis a lane.
class Planes {
 public:
  explicit Planes(const Box4& box) : lo_(box.lo) {
    const __m128 extent = _mm_sub_ps(box.hi, box.lo);
    const __m128 step = _mm_mul_ps(extent, _mm_set1_ps(1.0f / kBins));
    per_unit_ = _mm_div_ps(_mm_set1_ps(static_cast<float>(kBins)), extent);
    _mm_store_ps(lo_of_, lo_);
    _mm_store_ps(step_, step);
    // Planes closer than the coordinates' own spacing separate nothing.
    const __m128 distinct = _mm_and_ps(_mm_cmpgt_ps(_mm_add_ps(box.lo, step), box.lo),
                                       _mm_cmplt_ps(per_unit_, _mm_set1_ps(1e30f)));
    usable_ = _mm_movemask_ps(distinct);
    per_unit_ = _mm_and_ps(distinct, per_unit_);
  }
  bool usable(int axis) const { return ((usable_ >> axis) & 1) != 0; }
  float plane(int axis, int i) const { return lo_of_[axis] + step_[axis] * static_cast<float>(i); }
  __m128i bins_of(__m128 point) const {
    const __m128 x = _mm_mul_ps(_mm_sub_ps(point, lo_), per_unit_);
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(x, _mm_setzero_ps()), _mm_set1_ps(kBins - 1)));
  }

 private:
  __m128 lo_, per_unit_;
  alignas(16) float lo_of_[4], step_[4];
  int usable_;
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

struct Bins {
  Box4 box[3][kBins];
  std::uint32_t enter[3][kBins] = {}, leave[3][kBins] = {};  // references that begin and that end here

  void add(const CentrePose& pose, const Reference& r, const Planes& planes) {
    const Box4 b(r.box);
    alignas(16) std::int32_t first[4], last[4];
    const __m128 half_sum = _mm_mul_ps(b.sum(), _mm_set1_ps(0.5f));
    _mm_store_si128(reinterpret_cast<__m128i*>(first), planes.bins_of(r.is_instance() ? half_sum : b.lo));
    _mm_store_si128(reinterpret_cast<__m128i*>(last), planes.bins_of(r.is_instance() ? half_sum : b.hi));
    for (int axis = 0; axis < 3; ++axis) {
      ++enter[axis][first[axis]];
      ++leave[axis][last[axis]];
      if (first[axis] == last[axis]) {
        box[axis][first[axis]].grow(b);
      } else {
        walk(pose.corners(r), b, axis, first[axis], last[axis], planes);
      }
    }
  }
  void add(const Bins& other) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < kBins; ++b) {
        box[axis][b].grow(other.box[axis][b]);
        enter[axis][b] += other.enter[axis][b];
        leave[axis][b] += other.leave[axis][b];
      }
    }
  }

 private:
  // The parts of a triangle between planes: their corners are its own, and where the planes cut its edges.
  void walk(const std::array<const Vec3f*, 3>& corners, const Box4& whole, int axis, int first, int last,
            const Planes& planes) {
    const __m128 points[3] = {load4(corners[0]), load4(corners[1]), load4(corners[2])};
    const OrderedTriangle triangle(points, axis);
    const Box3f limits = whole.box();
    const float end = std::min(triangle.hi(), limits.hi[axis]);
    float x = std::max(triangle.lo(), limits.lo[axis]);
    Box4 section = triangle.section(x);
    for (int bin = first; bin <= last; ++bin) {
      const float next = bin == last ? end : planes.plane(axis, bin + 1);
      Box4 part = section;
      section = triangle.section(next);
      part.grow(section);
      if (triangle.middle() > x && triangle.middle() < next) part.grow(triangle.middle_corner());
      part = intersect(part, whole);
      if (!part.empty()) box[axis][bin].grow(part);
      x = next;
    }
  }
};

void sweep(const Bins& bins, int axis, const Planes& planes, SpatialSplit& best) {
  float right_cost[kBins];
  std::size_t right_count[kBins];
  Box4 box;
  std::size_t count = 0;
  for (int b = kBins - 1; b > 0; --b) {
    box.grow(bins.box[axis][b]);
    right_count[b] = count += bins.leave[axis][b];
    right_cost[b] = half_area(box) * block_count(count);
  }
  box = {};
  count = 0;
  for (int b = 1; b < kBins; ++b) {
    box.grow(bins.box[axis][b - 1]);
    count += bins.enter[axis][b - 1];
    if (count == 0 || right_count[b] == 0) continue;
    const float cost = half_area(box) * block_count(count) + right_cost[b];
    if (cost < best.cost) best = {cost, axis, planes.plane(axis, b), count, right_count[b]};
  }
}

bool is_cut(const Reference& r, const SpatialSplit& split) {
  return !r.is_instance() && r.box.lo[split.axis] < split.plane && r.box.hi[split.axis] > split.plane;
}

// False if all of it lies on one side, within the error of clipping.
bool cut(const CentrePose& pose, const SpatialSplit& split, Reference& r, Reference& right) {
  const CutBounds bounds = cut_bounds(pose.triangle(r), r.box, split.axis, split.plane);
  if (bounds.below.empty() || bounds.above.empty()) return false;
  r.owner |= Reference::kClippedFlag;
  right = r;
  r.box = bounds.below;
  right.box = bounds.above;
  return true;
}

}  // namespace

SpatialSplit find_spatial_split(const CentrePose& pose, std::span<const Reference> references,
                                const Box4& box) {
  const Planes planes(box);
  const Bins bins = reduce_in_chunks<Bins>(
      references.size(), kChunk, [] { return Bins(); },
      [&](Bins& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sum.add(pose, references[i], planes);
      },
      [](Bins& sum, const Bins& part) { sum.add(part); });
  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (planes.usable(axis)) sweep(bins, axis, planes, best);
  }
  return best;
}

std::size_t cut_references(const CentrePose& pose, std::span<Reference> references, std::size_t room,
                           const SpatialSplit& split) {
  Reference* const behind = references.data() + references.size();
  std::size_t count = 0;
  for (Reference& r : references) {
    if (count == room) break;
    if (is_cut(r, split) && cut(pose, split, r, behind[count])) ++count;
  }
  return count;
}

}  // namespace msbvh
