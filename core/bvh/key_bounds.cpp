#include "core/bvh/key_bounds.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/build/clip.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr std::uint32_t kMaxControls = kMaxSegments * kMaxDegree + 1;

float largest_coordinate(const Box3f& b) {
  const Vec3f m = max(abs(b.lo), abs(b.hi));
  return std::max({m.x, m.y, m.z});
}

Box3f padded(const Box3f& b, float pad) {
  const Vec3f p{pad, pad, pad};
  return {b.lo - p, b.hi + p};
}

Box3d in_double(const Box3f& b) { return {Vec3d(b.lo), Vec3d(b.hi)}; }

// Corners of the fragment as weights of the triangle's vertices, and its boxes at the mesh's own controls.
class MovingFragment {
 public:
  MovingFragment(const Primitives& primitives, const Reference& reference)
      : mesh_(*primitives.meshes[reference.mesh()]),
        triangle_(mesh_.triangles[reference.index]),
        polygon_(clip_to_box(centre_triangle<double>(primitives, reference), reference.box)) {}

  Box3f at_control(std::uint32_t control) const {
    const std::array<Vec3d, 3> v = vertices(control);
    if (polygon_.count == 0) return whole(v);
    Box3d box;
    for (int i = 0; i < polygon_.count; ++i) {
      const Vec3d& b = polygon_.corners[i];
      box.grow(v[0] * b.x + v[1] * b.y + v[2] * b.z);
    }
    return padded(round_outwards(box),
                  kFragmentPad * static_cast<float>(mesh_.degree) * size_around(control));
  }

 private:
  // The vertices in flight err by their own size, which may be larger at the segment's other controls.
  float size_around(std::uint32_t control) const {
    const std::uint32_t last = mesh_.form().controls() - 1, degree = mesh_.degree;
    float size = 0.0f;
    for (std::uint32_t c = control < degree ? 0 : control - degree; c <= std::min(control + degree, last);
         ++c) {
      size = std::max(size, largest_coordinate(whole(vertices(c))));
    }
    return size;
  }
  std::array<Vec3d, 3> vertices(std::uint32_t control) const {
    const Vec3f* p = mesh_.control_positions(control);
    return {Vec3d(p[triangle_[0]]), Vec3d(p[triangle_[1]]), Vec3d(p[triangle_[2]])};
  }
  static Box3f whole(const std::array<Vec3d, 3>& v) {
    Box3f box;
    for (const Vec3d& p : v) box.grow(Vec3f(p));  // exact: these were floats
    return box;
  }

  const TriangleMesh& mesh_;
  const Triangle& triangle_;
  BarycentricPolygon polygon_;
};

Box3f triangle_box(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control) {
  const Vec3f* p = mesh.control_positions(control);
  Box3f box;
  for (const std::uint32_t v : triangle) box.grow(p[v]);
  return box;
}

// The controls of a track that a tree sees: all of them, or those of the segment that its slice lies in.
struct ControlRange {
  std::uint32_t first, count;

  ControlRange(const TimeSlice& slice, const TrackForm& form) : first(0), count(form.controls()) {
    if (slice.whole() || !form.moving()) return;
    first = slice.index / (slice.count / form.segments) * form.degree;
    count = form.degree + 1;
  }
};

// The slice is a segment of the finest track, so that most tracks are only copied.
void grow_by_slice(std::span<Box3f> out, const TrackForm& form, const TimeSlice& slice,
                   std::span<const Box3f> segment, const TrackForm& track_form) {
  if (!track_form.moving()) return grow_track(out, form, segment, track_form);
  const std::uint32_t ratio = slice.count / track_form.segments, degree = track_form.degree;
  if (ratio == 1) return grow_track(out, form, segment, {1, degree});
  const TrackForm fine{ratio, form.degree};
  std::vector<Box3f> parts(fine.controls());
  grow_track(parts, fine, segment, {1, degree});
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

void grow_by_triangle(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                      const Reference& reference) {
  const TriangleMesh& mesh = *primitives.meshes[reference.mesh()];
  std::array<Box3f, kMaxControls> boxes;
  const auto [first, count] = ControlRange(primitives.slice, mesh.form());
  if (reference.is_clipped()) {
    const MovingFragment fragment(primitives, reference);
    for (std::uint32_t c = 0; c < count; ++c) boxes[c] = fragment.at_control(first + c);
  } else {
    const Triangle& triangle = mesh.triangles[reference.index];
    for (std::uint32_t c = 0; c < count; ++c) boxes[c] = triangle_box(mesh, triangle, first + c);
  }
  grow_node(out, form, primitives, {boxes.data(), count}, mesh.form());
}

// The part of one source segment that a segment of the finer form covers, in that form.
void grow_segment(Box3f* out, std::uint32_t degree, const Box3f* source, std::uint32_t source_degree,
                  double a, double b) {
  float size = 0.0f;
  for (std::uint32_t i = 0; i <= source_degree; ++i) size = std::max(size, largest_coordinate(source[i]));
  const float pad = kRekeyPad * static_cast<float>(degree) * size;
  const auto part = [&](std::uint32_t j) {
    return part_control([&](std::uint32_t i) { return in_double(source[i]); }, source_degree, a, b, j);
  };
  for (std::uint32_t j = 0; j <= degree; ++j) {
    out[j].grow(padded(round_outwards(elevated_control(part, source_degree, degree, j)), pad));
  }
}

}  // namespace

void grow_track(std::span<Box3f> out, const TrackForm& form, std::span<const Box3f> track,
                const TrackForm& track_form) {
  if (track_form == form) {
    for (std::uint32_t c = 0; c < form.controls(); ++c) out[c].grow(track[c]);
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
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const double a = double(k % ratio) / ratio, b = double(k % ratio + 1) / ratio;
    grow_segment(out.data() + k * form.degree, form.degree, track.data() + (k / ratio) * track_form.degree,
                 track_form.degree, a, b);
  }
}

void grow_by_reference(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                       const Reference& reference) {
  if (!reference.is_instance()) return grow_by_triangle(out, form, primitives, reference);
  const InstanceBounds& bounds = primitives.instances[reference.index];
  const auto [first, count] = ControlRange(primitives.slice, bounds.form);
  grow_node(out, form, primitives, std::span(bounds.controls).subspan(first, count), bounds.form);
}

double mean_half_area(std::span<const Box3f> controls, const TrackForm& form) {
  const auto area = [](const Box3d& b) { return half_area(b); };
  if (!form.moving()) return area(in_double(controls[0]));
  double sum = 0.0;
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const Box3f* segment = controls.data() + k * form.degree;
    const auto at = [&](double w) {
      return area(bezier([&](std::uint32_t i) { return in_double(segment[i]); }, form.degree, w));
    };
    if (form.degree == 1) {
      sum += (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;  // Simpson: exact up to degree 3
    } else {
      // Gauss-Legendre with 4 points: exact up to degree 7.
      constexpr double kNear = 0.33000947820757187, kFar = 0.06943184420297371;
      constexpr double kNearWeight = 0.32607257743127307, kFarWeight = 0.17392742256872693;
      sum += kNearWeight * (at(kNear) + at(1.0 - kNear)) + kFarWeight * (at(kFar) + at(1.0 - kFar));
    }
  }
  return sum / form.segments;
}

}  // namespace msbvh
