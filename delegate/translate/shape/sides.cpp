#include "delegate/translate/shape/sides.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/affine.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

// One of the shapes over the shutter.
class Seen {
 public:
  void add(const Matrix4d& matrix, double radius, const BoxCorners& corners, bool is_sphere,
           const PixelSize& pixel_size) {
    finite_ = finite_ && std::ranges::all_of(matrix, [](double element) { return std::isfinite(element); });
    const Stretch stretch = stretch_of(matrix);
    most_ = std::max(most_, stretch.most);
    const Affine3d map = affine_from(matrix);
    if (is_sphere) {  // The eye may be inside of one that stands for the sky.
      size_ = std::min(size_, pixel_size.at_shell(map.t, stretch.most * radius, stretch.least * radius));
    } else {
      box_.grow(bounds_of(corners, map));
    }
  }

  double radius_in_pixels(double radius, bool is_sphere, const PixelSize& pixel_size) const {
    if (!finite_ || radius == 0.0) return std::numeric_limits<double>::quiet_NaN();
    return most_ * radius / (is_sphere ? size_ : pixel_size.at_box(box_));
  }

 private:
  bool finite_ = true;
  double most_ = 0.0;
  double size_ = std::numeric_limits<double>::infinity();  // of a pixel, where it is smallest
  Box3d box_;
};

}  // namespace

double stray_of(int sides) { return 2.0 * (1.0 - std::cos(std::numbers::pi / sides)); }

double stray_of(ImplicitKind kind, int sides) {
  const double half = std::numbers::pi / sides, chord = std::cos(half), rise = std::sin(half);
  switch (kind) {
    case ImplicitKind::kSphere:
    case ImplicitKind::kCapsule:
    case ImplicitKind::kCapsule1:
      return 1.0 - chord / std::sqrt(1.0 + rise * rise);
    case ImplicitKind::kCone:
    case ImplicitKind::kCylinder:
    case ImplicitKind::kCylinder1:
      return 1.0 - chord;
    default:
      return 0.0;
  }
}

std::vector<int> sides_for(std::span<const double> radii_pixels, double silhouette_pixels,
                           std::span<const int> counts) {
  std::vector<double> largest;  // radii that each of the counts is enough for
  for (const int sides : counts) largest.push_back(silhouette_pixels / stray_of(sides));
  std::vector<int> result;
  result.reserve(radii_pixels.size());
  for (const double radius : radii_pixels) {
    const std::size_t place = std::size_t(std::ranges::lower_bound(largest, radius) - largest.begin());
    result.push_back(std::isnan(radius) ? kUnmeasuredSides : counts[std::min(place, counts.size() - 1)]);
  }
  return result;
}

Stretch stretch_of(const Matrix4d& matrix) {
  const Affine3d map = affine_from(matrix);
  const Vec3d rows[] = {map.x, map.y, map.z};
  double most = -std::numeric_limits<double>::infinity(), least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double square = dot(rows[i], rows[i]);
    const double beside =
        std::abs(dot(rows[i], rows[(i + 1) % 3])) + std::abs(dot(rows[i], rows[(i + 2) % 3]));
    most = std::max(most, square + beside);
    least = std::min(least, square - beside);
  }
  return {std::sqrt(std::max(most, 0.0)), std::sqrt(std::max(least, 0.0))};
}

std::vector<double> radii_in_pixels(ImplicitKind kind, double radius, const Box3d& box,
                                    std::span<const Matrix4d> matrices, std::size_t count,
                                    const PixelSize& pixel_size) {
  const bool is_sphere = kind == ImplicitKind::kSphere;
  const BoxCorners corners = corners_of(box);
  std::vector<Seen> shapes(count);
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    shapes[i % count].add(matrices[i], radius, corners, is_sphere, pixel_size);
  }
  std::vector<double> result;
  result.reserve(count);
  for (const Seen& seen : shapes) result.push_back(seen.radius_in_pixels(radius, is_sphere, pixel_size));
  return result;
}

}  // namespace msbvh::translate
