#include "core/bvh/key_bounds.h"

#include <array>
#include <vector>

#include "core/build/clip.h"
#include "core/build/grid_clip.h"
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

// A triangle's fragment on the move: corners as weights of the vertices. `Vertices` gives them in double,
// each an exact float, at a control of the triangle's own track.
template <typename Vertices>
class MovingFragment {
 public:
  MovingFragment(const BarycentricPolygon& polygon, const TrackForm& form, const Vertices& vertices)
      : polygon_(polygon), form_(form), vertices_(vertices) {}

  Box3f at_control(std::uint32_t control) const {
    const std::array<Vec3d, 3> v = vertices_(control);
    if (polygon_.count == 0) return whole(v);
    Box3d box;
    for (int i = 0; i < polygon_.count; ++i) {
      const Vec3d& b = polygon_.corners[i];
      box.grow(v[0] * b.x + v[1] * b.y + v[2] * b.z);
    }
    return padded(round_outwards(box),
                  kFragmentPad * static_cast<float>(form_.degree) * size_around(control));
  }

 private:
  // The vertices in flight err by their own size, which may be larger at the segment's other controls.
  float size_around(std::uint32_t control) const {
    const std::uint32_t last = form_.controls() - 1, degree = form_.degree;
    float size = 0.0f;
    for (std::uint32_t c = control < degree ? 0 : control - degree; c <= std::min(control + degree, last);
         ++c) {
      size = std::max(size, largest_coordinate(whole(vertices_(c))));
    }
    return size;
  }
  static Box3f whole(const std::array<Vec3d, 3>& v) {
    Box3f box;
    for (const Vec3d& p : v) box.grow(Vec3f(p));  // exact: these were floats
    return box;
  }

  const BarycentricPolygon& polygon_;
  TrackForm form_;
  const Vertices& vertices_;
};

Box3f triangle_box(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t control) {
  const Vec3f* p = mesh.control_positions(control);
  Box3f box;
  for (const std::uint32_t v : triangle) box.grow(p[v]);
  return box;
}

void grow_by_triangle(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                      const Reference& reference) {
  const TriangleMesh& mesh = *primitives.meshes[reference.mesh()];
  std::array<Box3f, kMaxControls> boxes;
  const std::uint32_t count = mesh.form().controls();
  if (reference.is_clipped()) {
    const BarycentricPolygon polygon =
        clip_to_box(centre_triangle<double>(primitives, reference), reference.box);
    const Triangle& t = mesh.triangles[reference.index];
    const auto vertices = [&](std::uint32_t control) {
      const Vec3f* p = mesh.control_positions(control);
      return std::array{Vec3d(p[t[0]]), Vec3d(p[t[1]]), Vec3d(p[t[2]])};
    };
    const MovingFragment fragment(polygon, mesh.form(), vertices);
    for (std::uint32_t c = 0; c < count; ++c) boxes[c] = fragment.at_control(c);
  } else {
    const Triangle& triangle = mesh.triangles[reference.index];
    for (std::uint32_t c = 0; c < count; ++c) boxes[c] = triangle_box(mesh, triangle, c);
  }
  grow_track(out, form, {boxes.data(), count}, mesh.form());
}

// The parts of a patch inside the reference's box, all together.
void grow_by_parts(std::span<Box3f> boxes, const Primitives& primitives, const Reference& reference) {
  const GridMesh& mesh = *primitives.grids[reference.grid_mesh()];
  const auto part = [&](const GridTriangle& triangle, const BarycentricPolygon* polygon) {
    const std::array<GridVertex, 3> v = vertices_of(triangle);
    const Grid& grid = mesh.grids[triangle.grid];
    const auto vertices = [&](std::uint32_t control) {
      return std::array{Vec3d(mesh.control_point(grid, v[0].row, v[0].column, control)),
                        Vec3d(mesh.control_point(grid, v[1].row, v[1].column, control)),
                        Vec3d(mesh.control_point(grid, v[2].row, v[2].column, control))};
    };
    const BarycentricPolygon all;
    const MovingFragment fragment(polygon ? *polygon : all, mesh.form(), vertices);
    for (std::uint32_t c = 0; c < boxes.size(); ++c) boxes[c].grow(fragment.at_control(c));
  };
  centre_patch(primitives, reference).visit(reference.box, part);
}

void grow_by_patch(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                   const Reference& reference) {
  const GridMesh& mesh = *primitives.grids[reference.grid_mesh()];
  std::array<Box3f, kMaxControls> boxes;
  const std::uint32_t count = mesh.form().controls();
  if (reference.is_clipped()) {
    grow_by_parts({boxes.data(), count}, primitives, reference);
  }
  if (boxes[0].empty()) {  // no fragment, or nothing of it is left by rounding: more is always right
    for (std::uint32_t c = 0; c < count; ++c) boxes[c] = mesh.bounds(mesh.patches[reference.index], c);
  }
  grow_track(out, form, {boxes.data(), count}, mesh.form());
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
  if (reference.is_grid()) return grow_by_patch(out, form, primitives, reference);
  if (!reference.is_instance()) return grow_by_triangle(out, form, primitives, reference);
  const InstanceBounds& bounds = primitives.instances[reference.index];
  grow_track(out, form, bounds.controls, bounds.form);
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
