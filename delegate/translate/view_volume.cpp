#include "delegate/translate/view_volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "delegate/translate/screen_measure.h"

namespace msbvh::translate {
namespace {

// A filter may reach so many pixels over the picture's sides.
constexpr double kFilterPixels = 2.0;

double binomial(std::size_t n, std::size_t k) {
  double result = 1.0;
  for (std::size_t i = 0; i < k; ++i) result = result * double(n - i) / double(i + 1);
  return result;
}

// Of two polynomials in the Bernstein basis (Farin, section 6.10), which `multiply` makes one.
template <typename A, typename B, typename Multiply>
auto product(const std::vector<A>& a, const std::vector<B>& b, Multiply multiply) {
  const std::size_t m = a.size() - 1, n = b.size() - 1;
  std::vector<decltype(multiply(a[0], b[0]))> result(m + n + 1);
  for (std::size_t i = 0; i <= m; ++i) {
    for (std::size_t j = 0; j <= n; ++j) {
      const double share = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
      result[i + j] = result[i + j] + multiply(a[i], b[j]) * share;
    }
  }
  return result;
}

// A half-space of camera space: normal . p > offset.
struct CameraPlane {
  Vec3d normal;
  double offset;
};
using CameraSide = std::vector<CameraPlane>;

// Window, lens and clipping range at their widest in a segment.
struct Widest {
  double left, right, bottom, top;
  double radius = 0.0, least_curvature = 0.0, largest_curvature = 0.0;  // of the lens; 1 / focus distance
  double near_clip;
};

template <typename T>
std::span<const T> controls_of(const std::vector<T>& track, std::uint32_t segment, std::uint32_t degree) {
  return std::span(track).subspan(std::size_t(segment) * degree, track.size() == 1 ? 1 : degree + 1);
}

Widest widest(const Camera& camera, std::uint32_t segment, std::uint32_t width, std::uint32_t height) {
  Widest result{1e300, -1e300, 1e300, -1e300, 0.0, 0.0, 0.0, double(camera.near_clip)};
  for (const ScreenWindow& w : controls_of(camera.window, segment, camera.degree)) {
    result.left = std::min({result.left, double(w.left), double(w.right)});
    result.right = std::max({result.right, double(w.left), double(w.right)});
    result.bottom = std::min({result.bottom, double(w.bottom), double(w.top)});
    result.top = std::max({result.top, double(w.bottom), double(w.top)});
  }
  const double x = (result.right - result.left) * std::max(View::kMargin, kFilterPixels / width);
  const double y = (result.top - result.bottom) * std::max(View::kMargin, kFilterPixels / height);
  result.left -= x;
  result.right += x;
  result.bottom -= y;
  result.top += y;
  if (!camera.lens.empty()) {
    result.least_curvature = 1e300;
    for (const Lens& lens : controls_of(camera.lens, segment, camera.degree)) {
      result.radius = std::max(result.radius, double(lens.radius));
      result.least_curvature = std::min(result.least_curvature, 1.0 / lens.focus_distance);
      result.largest_curvature = std::max(result.largest_curvature, 1.0 / lens.focus_distance);
    }
  }
  for (const ClipRange& clip : camera.clip)
    result.near_clip = std::min(result.near_clip, double(clip.near_clip));
  return result;
}

// Beyond one side of the window: `along` x or y, or its negative, and the side at unit distance along it.
CameraSide beyond(const Vec3d& along, double side, const Widest& w, bool perspective) {
  if (!perspective) return {{along, side}};
  if (w.radius == 0.0) return {{along + Vec3d{0.0, 0.0, side}, 0.0}};
  CameraSide result;
  for (const double curvature : {w.least_curvature, w.largest_curvature}) {
    const double tilt = w.radius * curvature;
    result.push_back({along + Vec3d{0.0, 0.0, side - tilt}, w.radius});
    result.push_back({along + Vec3d{0.0, 0.0, side + tilt}, -w.radius});
  }
  return result;
}

std::vector<CameraSide> sides_of(const Widest& w, bool perspective) {
  // Rounding of an eye far from the origin has no window's margin here.
  const double slack = 1e-3 * (w.top - w.bottom);
  const double nearest = perspective ? 0.0 : slack - w.near_clip;
  return {beyond({1, 0, 0}, w.right, w, perspective),
          beyond({-1, 0, 0}, -w.left, w, perspective),
          beyond({0, 1, 0}, w.top, w, perspective),
          beyond({0, -1, 0}, -w.bottom, w, perspective),
          {{{0, 0, 1}, nearest}}};
}

// A segment of the camera's curve as polynomials.
struct Curve {
  std::vector<Vec3d> x, y, z, eye;
};

Curve curve_of(std::span<const Affine3f> maps) {
  Curve result;
  for (const Affine3f& map : maps) {
    result.x.push_back(Vec3d(map.x));
    result.y.push_back(Vec3d(map.y));
    result.z.push_back(Vec3d(map.z));
    result.eye.push_back(Vec3d(map.t));
  }
  return result;
}

}  // namespace

bool ViewVolume::HalfSpace::contains(const Box3d& box) const {
  const Vec3d size = abs(normal);
  return dot(normal, box.center()) - 0.5 * dot(size, box.extent()) > offset;
}

ViewVolume::ViewVolume(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const auto dot_product = [](const Vec3d& a, const Vec3d& b) { return dot(a, b); };
  const auto cross_product = [](const Vec3d& a, const Vec3d& b) { return cross(a, b); };
  for (std::uint32_t s = 0; s < std::max(camera.segments, 1u); ++s) {
    const Curve curve = curve_of(controls_of(camera.world_from_camera, s, camera.degree));
    const auto yz = product(curve.y, curve.z, cross_product), zx = product(curve.z, curve.x, cross_product),
               xy = product(curve.x, curve.y, cross_product);
    const std::vector<double> volume = product(curve.x, yz, dot_product);
    const double sign = volume[0] < 0.0 ? -1.0 : 1.0;
    Segment& segment = segments_.emplace_back();
    // A camera that turns inside out has no sides that this could know.
    if (!std::ranges::all_of(volume, [sign](double v) { return v * sign > 0.0; })) continue;
    const bool perspective = camera.projection == Projection::kPerspective;
    for (const CameraSide& side : sides_of(widest(camera, s, width, height), perspective)) {
      Side& world = segment.emplace_back();
      for (const CameraPlane& plane : side) {
        std::vector<Vec3d> normal(yz.size());
        for (std::size_t i = 0; i < normal.size(); ++i)
          normal[i] = (yz[i] * plane.normal.x + zx[i] * plane.normal.y + xy[i] * plane.normal.z) * sign;
        const std::vector<double> at_eye = product(normal, curve.eye, dot_product);
        // Raised to the degree of the others.
        const std::vector<double> one(curve.eye.size(), 1.0);
        const auto raised = product(normal, one, [](const Vec3d& n, double w) { return n * w; });
        for (std::size_t i = 0; i < raised.size(); ++i)
          world.push_back({raised[i], at_eye[i] + plane.offset * volume[i] * sign});
      }
    }
  }
}

bool ViewVolume::misses(const Box3d& box) const {
  if (box.empty()) return true;
  return std::ranges::all_of(segments_, [&](const Segment& segment) {
    return std::ranges::any_of(segment, [&](const Side& side) {
      return std::ranges::all_of(side, [&](const HalfSpace& half) { return half.contains(box); });
    });
  });
}

}  // namespace msbvh::translate
