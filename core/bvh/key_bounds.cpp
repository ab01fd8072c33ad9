#include "core/bvh/key_bounds.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "core/build/box4.h"
#include "core/build/clip.h"
#include "core/build/grid_clip.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

Box3d in_double(const Box3f& b) { return {Vec3d(b.lo), Vec3d(b.hi)}; }

// A point, or the corner of a box, in double.
struct Point2 {
  __m128d xy, zz;

  explicit Point2(__m128 v) : xy(_mm_cvtps_pd(v)), zz(_mm_cvtps_pd(_mm_movehl_ps(v, v))) {}
  Point2(__m128d xy_, __m128d zz_) : xy(xy_), zz(zz_) {}
  Vec3d vec() const {
    double x[2];
    _mm_storeu_pd(x, xy);
    return {x[0], x[1], _mm_cvtsd_f64(zz)};
  }
};
Point2 operator*(const Point2& a, __m128d s) { return {_mm_mul_pd(a.xy, s), _mm_mul_pd(a.zz, s)}; }
Point2 operator+(const Point2& a, const Point2& b) {
  return {_mm_add_pd(a.xy, b.xy), _mm_add_pd(a.zz, b.zz)};
}
Point2 min(const Point2& a, const Point2& b) { return {_mm_min_pd(a.xy, b.xy), _mm_min_pd(a.zz, b.zz)}; }
Point2 max(const Point2& a, const Point2& b) { return {_mm_max_pd(a.xy, b.xy), _mm_max_pd(a.zz, b.zz)}; }

// Of a triangle at a control of its track.
struct Corners {
  __m128 v[3];

  Corners(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control) {
    const Vec3f* p = mesh.control_positions(control);
    for (int i = 0; i < 3; ++i) v[i] = load4(p + triangle[i]);  // the guard of TriangleMesh makes room
  }
  Corners(const GridMesh& mesh, const GridTriangle& triangle, std::uint32_t control) {
    const std::array<GridVertex, 3> at = vertices_of(triangle);
    for (int i = 0; i < 3; ++i) {
      const Vec3f p = mesh.control_point(mesh.grids[triangle.grid], at[i].row, at[i].column, control);
      v[i] = _mm_setr_ps(p.x, p.y, p.z, 0.0f);
    }
  }
  Box4 box() const {
    Box4 box;
    for (const __m128& p : v) box.grow(p);
    return box;
  }
};

Box3d weighed_bounds(const Corners& corners, const BarycentricPolygon& polygon) {
  const Point2 v[3] = {Point2(corners.v[0]), Point2(corners.v[1]), Point2(corners.v[2])};
  const __m128d infinity = _mm_set1_pd(std::numeric_limits<double>::infinity());
  Point2 lo{infinity, infinity}, hi = lo * _mm_set1_pd(-1.0);
  for (int i = 0; i < polygon.count; ++i) {
    const Vec3d& b = polygon.corners[i];
    const Point2 p = v[0] * _mm_set1_pd(b.x) + v[1] * _mm_set1_pd(b.y) + v[2] * _mm_set1_pd(b.z);
    lo = min(lo, p);
    hi = max(hi, p);
  }
  return {lo.vec(), hi.vec()};
}

// Boxes of a whole triangle at its track's own controls.
template <typename Mesh, typename Triangle>
void triangle_track(std::span<Box3f> out, const Mesh& mesh, const Triangle& triangle) {
  for (std::uint32_t c = 0; c < out.size(); ++c) Corners(mesh, triangle, c).box().store(out[c]);
}

// Of a fragment: its corners are weights of the triangle's vertices.
template <typename Mesh, typename Triangle>
void fragment_track(std::span<Box3f> out, const Mesh& mesh, const Triangle& triangle,
                    const BarycentricPolygon& polygon) {
  const auto last = static_cast<std::uint32_t>(out.size() - 1), degree = mesh.degree;
  triangle_track(out, mesh, triangle);
  if (polygon.count == 0) return;  // whole
  // The vertices in flight err by their own size, which may be larger at the segment's other controls. `out`
  // still holds the whole triangle behind `c`; `size` remembers what is in front.
  std::array<float, 2 * kMaxDegree + 1> size;
  const auto size_at = [&](std::uint32_t c) -> float& { return size[c % size.size()]; };
  for (std::uint32_t c = 0; c < std::min(degree, last + 1); ++c) size_at(c) = largest_coordinate(out[c]);
  for (std::uint32_t c = 0; c <= last; ++c) {
    if (c + degree <= last) size_at(c + degree) = largest_coordinate(out[c + degree]);
    float around = 0.0f;
    for (std::uint32_t k = c < degree ? 0 : c - degree; k <= std::min(c + degree, last); ++k)
      around = std::max(around, size_at(k));
    out[c] = padded(round_outwards(weighed_bounds(Corners(mesh, triangle, c), polygon)),
                    kFragmentPad * static_cast<float>(degree) * around);
  }
}

void grow(Box3f& box, const Box4& by) {
  Box4 grown(box);
  grown.grow(by);
  grown.store(box);
}

Box4 padded(const Box4& b, float pad) {
  const __m128 p = _mm_set1_ps(pad);
  return {_mm_sub_ps(b.lo, p), _mm_add_ps(b.hi, p)};
}

// As lerp() at 0.5.
Box4 halfway(const Box4& a, const Box4& b) {
  const __m128 half = _mm_set1_ps(0.5f);
  const auto between = [&](__m128 x, __m128 y) {
    return _mm_add_ps(_mm_mul_ps(half, x), _mm_mul_ps(half, y));
  };
  return {between(a.lo, b.lo), between(a.hi, b.hi)};
}

float largest_coordinate(const Box4& b) {
  const __m128 sign = _mm_set1_ps(-0.0f);
  alignas(16) float m[4];
  _mm_store_ps(m, _mm_max_ps(_mm_andnot_ps(sign, b.lo), _mm_andnot_ps(sign, b.hi)));
  return std::max({m[0], m[1], m[2]});
}

// How far `inner` reaches out of `outer`, side by side; never negative.
struct Excess {
  __m128 lo = _mm_setzero_ps(), hi = _mm_setzero_ps();

  void grow(const Box4& inner, const Box4& outer) {
    lo = _mm_max_ps(lo, _mm_sub_ps(outer.lo, inner.lo));
    hi = _mm_max_ps(hi, _mm_sub_ps(inner.hi, outer.hi));
  }
  void grow(const Excess& e) {
    lo = _mm_max_ps(lo, e.lo);
    hi = _mm_max_ps(hi, e.hi);
  }
};

// The controls of a track that a tree sees: all of them, or those of the segments that its slice lies in, or
// that lie in its slice.
struct ControlRange {
  std::uint32_t first, count;

  ControlRange(const TimeSlice& slice, const TrackForm& form) : first(0), count(form.controls()) {
    if (slice.whole() || !form.moving()) return;
    const std::uint32_t segments = std::max(1u, form.segments / slice.count);
    first = slice.index * form.segments / slice.count * form.degree;
    count = segments * form.degree + 1;
  }
};

// Slice and segments nest. Segments that lie in the slice become one.
void grow_by_slice(std::span<Box3f> out, const TrackForm& form, const TimeSlice& slice,
                   std::span<const Box3f> track, const TrackForm& track_form) {
  if (!track_form.moving()) return grow_track(out, form, track, track_form);
  const std::uint32_t degree = track_form.degree;
  std::vector<Box3f> whole(track.begin(), track.end());
  for (std::uint32_t segments = track_form.segments / slice.count; segments > 1; segments /= 2) {
    std::vector<Box3f> half(segments / 2 + 1);
    halve_segments(whole, half);
    whole = std::move(half);
  }
  const std::uint32_t ratio = std::max(1u, slice.count / track_form.segments);
  if (ratio == 1) return grow_track(out, form, whole, {1, degree});
  const TrackForm fine{ratio, form.degree};
  std::vector<Box3f> parts(fine.controls());
  grow_track(parts, fine, whole, {1, degree});
  const auto first = parts.begin() + static_cast<std::ptrdiff_t>(slice.index % ratio * form.degree);
  for (std::uint32_t i = 0; i <= form.degree; ++i) out[i].grow(first[i]);
}

// A box around all controls, which interpolation leaves by its rounding at most.
void grow_by_all(Box3f& out, std::span<const Box3f> track, const TrackForm& form) {
  Box3f all;
  for (const Box3f& box : track) all.grow(box);
  const float pad =
      form.moving() ? kRekeyPad * static_cast<float>(form.degree) * largest_coordinate(all) : 0.0f;
  out.grow(padded(all, pad));
}

// As the tree of `primitives` keeps it, see node_form_of(); `track` has the controls of a ControlRange.
void grow_node(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
               std::span<const Box3f> track, const TrackForm& track_form) {
  if (primitives.swept) return grow_by_all(out[0], track, track_form);
  if (!primitives.slice.whole()) return grow_by_slice(out, form, primitives.slice, track, track_form);
  grow_track(out, form, track, track_form);
}

// Boxes at the controls of a track, empty at first.
class TrackBoxes {
 public:
  explicit TrackBoxes(std::uint32_t count) : count_(count) {
    if (count > kFew) many_.resize(count);
  }
  std::span<Box3f> span() { return {count_ > kFew ? many_.data() : few_, count_}; }

 private:
  static constexpr std::uint32_t kFew = 9;  // longer tracks take longer than an allocation
  Box3f few_[kFew];
  std::vector<Box3f> many_;
  const std::uint32_t count_;
};

void grow_by_triangle(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                      const Reference& reference) {
  const TriangleMesh& mesh = *primitives.meshes[reference.mesh()];
  const Triangle& triangle = mesh.triangles[reference.index];
  if (mesh.form() == form && !reference.is_clipped() && primitives.slice.whole()) {
    for (std::uint32_t c = 0; c < out.size(); ++c) grow(out[c], Corners(mesh, triangle, c).box());
    return;
  }
  TrackBoxes boxes(mesh.form().controls());
  if (reference.is_clipped()) {
    fragment_track(boxes.span(), mesh, triangle,
                   clip_to_box(centre_triangle<double>(primitives, reference), reference.box));
  } else {
    triangle_track(boxes.span(), mesh, triangle);
  }
  const ControlRange range(primitives.slice, mesh.form());
  grow_node(out, form, primitives, boxes.span().subspan(range.first, range.count), mesh.form());
}

// The parts of a patch inside the reference's box, all together.
void grow_by_parts(std::span<Box3f> boxes, const Primitives& primitives, const Reference& reference) {
  const GridMesh& mesh = *primitives.grids[reference.grid_mesh()];
  TrackBoxes part(mesh.form().controls());
  centre_patch(primitives, reference)
      .visit(reference.box, [&](const GridTriangle& triangle, const BarycentricPolygon* polygon) {
        if (polygon) {
          fragment_track(part.span(), mesh, triangle, *polygon);
        } else {
          triangle_track(part.span(), mesh, triangle);
        }
        for (std::size_t c = 0; c < boxes.size(); ++c) grow(boxes[c], Box4(part.span()[c]));
      });
}

void grow_by_patch(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                   const Reference& reference) {
  const GridMesh& mesh = *primitives.grids[reference.grid_mesh()];
  TrackBoxes boxes(mesh.form().controls());
  const std::span<Box3f> track = boxes.span();
  if (reference.is_clipped()) grow_by_parts(track, primitives, reference);
  if (track[0].empty()) {  // no fragment, or nothing of it is left by rounding: more is always right
    for (std::uint32_t c = 0; c < track.size(); ++c) track[c] = mesh.bounds(mesh.patches[reference.index], c);
  }
  const ControlRange range(primitives.slice, mesh.form());
  grow_node(out, form, primitives, track.subspan(range.first, range.count), mesh.form());
}

void grow_by_round(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                   const Reference& reference) {
  const TrackForm own = form_of(primitives, reference);
  TrackBoxes boxes(own.controls());
  for (std::uint32_t c = 0; c < own.controls(); ++c) boxes.span()[c] = round_box(primitives, reference, c);
  const ControlRange range(primitives.slice, own);
  grow_node(out, form, primitives, boxes.span().subspan(range.first, range.count), own);
}

float largest_coordinate(std::span<const Box3f> boxes) {
  float size = 0.0f;
  for (const Box3f& box : boxes) size = std::max(size, largest_coordinate(box));
  return size;
}

// A source segment in `ratio` segments, both linear: what grow_segment() does, with each key made once.
void grow_linear_segment(std::span<Box3f> out, std::span<const Box3f> source) {
  const auto ratio = static_cast<std::uint32_t>(out.size() - 1);
  const float pad = kRekeyPad * largest_coordinate(source);
  grow(out[0], padded(Box4(source[0]), pad));
  grow(out[ratio], padded(Box4(source[1]), pad));
  const Box3d begin = in_double(source[0]), end = in_double(source[1]);
  for (std::uint32_t i = 1; i < ratio; ++i) {
    const double w = double(i) / ratio;
    out[i].grow(padded(round_outwards(lerp(begin, end, w)), pad));
  }
}

// The part of one source segment that a segment of the finer form covers, in that form.
void grow_segment(Box3f* out, std::uint32_t degree, const Box3f* source, std::uint32_t source_degree,
                  double a, double b) {
  const float pad = kRekeyPad * static_cast<float>(degree) * largest_coordinate({source, source_degree + 1});
  const auto part = [&](std::uint32_t j) {
    return part_control([&](std::uint32_t i) { return in_double(source[i]); }, source_degree, a, b, j);
  };
  for (std::uint32_t j = 0; j <= degree; ++j) {
    out[j].grow(padded(round_outwards(elevated_control(part, source_degree, degree, j)), pad));
  }
}

}  // namespace

float largest_coordinate(const Box3f& b) {
  const Vec3f m = max(abs(b.lo), abs(b.hi));
  return std::max({m.x, m.y, m.z});
}

Box3f padded(const Box3f& b, float pad) {
  const Vec3f p{pad, pad, pad};
  return {b.lo - p, b.hi + p};
}

void grow_track(std::span<Box3f> out, const TrackForm& form, std::span<const Box3f> track,
                const TrackForm& track_form) {
  if (track_form == form) {
    for (std::uint32_t c = 0; c < form.controls(); ++c) grow(out[c], Box4(track[c]));
    return;
  }
  if (!track_form.moving()) {
    // (1 - w) x + w x may round below x: the weights need not sum to 1 in floating point.
    const float pad = kRekeyPad * static_cast<float>(form.degree) * largest_coordinate(track[0]);
    const Box3f box = padded(track[0], pad);
    for (std::uint32_t c = 0; c < form.controls(); ++c) out[c].grow(box);
    return;
  }
  const std::uint32_t ratio = form.segments / track_form.segments;
  if (form.degree == 1) {
    for (std::uint32_t k = 0; k < track_form.segments; ++k)
      grow_linear_segment(out.subspan(std::size_t(k) * ratio, ratio + 1), track.subspan(k, 2));
    return;
  }
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const double a = double(k % ratio) / ratio, b = double(k % ratio + 1) / ratio;
    grow_segment(out.data() + k * form.degree, form.degree, track.data() + (k / ratio) * track_form.degree,
                 track_form.degree, a, b);
  }
}

void halve_segments(std::span<const Box3f> fine, std::span<Box3f> coarse) {
  if (coarse.size() == 1) {  // two keys: at rest in the box around both
    coarse[0] = fine[0];
    coarse[0].grow(fine[1]);
    coarse[0] = padded(coarse[0], kRekeyPad * largest_coordinate(coarse[0]));
    return;
  }
  Excess before;
  Box4 key(fine[0]);
  float size_before = 0.0f, size = largest_coordinate(key);
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    Excess excess = before;
    before = {};
    Box4 next;
    float size_after = 0.0f;
    if (k + 1 < coarse.size()) {
      next = Box4(fine[2 * k + 2]);
      before.grow(Box4(fine[2 * k + 1]), halfway(key, next));
      size_after = largest_coordinate(next);
    }
    excess.grow(before);
    const Box4 lifted(_mm_sub_ps(key.lo, excess.lo), _mm_add_ps(key.hi, excess.hi));
    padded(lifted, kRekeyPad * std::max({size_before, size, size_after})).store(coarse[k]);
    key = next;
    size_before = size;
    size = size_after;
  }
}

void grow_by_reference(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                       const Reference& reference) {
  if (reference.is_grid()) return grow_by_patch(out, form, primitives, reference);
  if (reference.is_round()) return grow_by_round(out, form, primitives, reference);
  if (!reference.is_instance()) return grow_by_triangle(out, form, primitives, reference);
  const InstanceBounds& bounds = primitives.instances[reference.index];
  const ControlRange range(primitives.slice, bounds.form);
  grow_node(out, form, primitives, std::span(bounds.controls).subspan(range.first, range.count), bounds.form);
}

}  // namespace msbvh
