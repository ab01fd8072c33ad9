#include "delegate/translate/rigid.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

Affine3d linear_part(const Affine3d& map) { return {map.x, map.y, map.z, {}}; }

// cofactor(A) / det(A)
Affine3d inverse_transpose(const Affine3d& map, double determinant) {
  const double s = 1.0 / determinant;
  return {cross(map.y, map.z) * s, cross(map.z, map.x) * s, cross(map.x, map.y) * s, {}};
}

Affine3d transpose(const Affine3d& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}, {}};
}

double square_norm(const Affine3d& m) { return dot(m.x, m.x) + dot(m.y, m.y) + dot(m.z, m.z); }

// Newton's iteration for the orthogonal factor, scaled (Higham, "Computing the Polar Decomposition", SIAM J.
// Sci. Stat. Comput. 7, 1986). Converges quadratically; scaling saves the first steps of ill-conditioned
// maps.
Affine3d orthogonal_factor(Affine3d x) {
  constexpr int kMaxSteps = 64;
  constexpr double kConverged = 1e-28;  // square of the largest change, relative to elements of size 1
  for (int step = 0; step < kMaxSteps; ++step) {
    const Affine3d y = inverse_transpose(x, x.determinant());
    const double scale = std::pow(square_norm(y) / square_norm(x), 0.25);
    const double a = 0.5 * scale, b = 0.5 / scale;
    const Affine3d next{x.x * a + y.x * b, x.y * a + y.y * b, x.z * a + y.z * b, {}};
    const Affine3d change{next.x - x.x, next.y - x.y, next.z - x.z, {}};
    x = next;
    if (square_norm(change) < kConverged) break;
  }
  return x;
}

}  // namespace

// Shepperd, "Quaternion from rotation matrix" (1978): divides by the largest of the four components.
Quaternion rotation_of(const Affine3d& m) {
  const double diagonal[3] = {m.x.x, m.y.y, m.z.z};
  const double trace = diagonal[0] + diagonal[1] + diagonal[2];
  const int i = int(std::max_element(diagonal, diagonal + 3) - diagonal);
  if (trace > diagonal[i]) {
    const double w = 0.5 * std::sqrt(std::max(0.0, 1.0 + trace)), s = 0.25 / w;
    return {w, {(m.y.z - m.z.y) * s, (m.z.x - m.x.z) * s, (m.x.y - m.y.x) * s}};
  }
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const Vec3d columns[3] = {m.x, m.y, m.z};
  const double largest = 0.5 * std::sqrt(std::max(0.0, 1.0 + diagonal[i] - diagonal[j] - diagonal[k]));
  const double s = 0.25 / largest;
  Quaternion q;
  q.w = (columns[j][k] - columns[k][j]) * s;
  q.v[i] = largest;
  q.v[j] = (columns[i][j] + columns[j][i]) * s;
  q.v[k] = (columns[i][k] + columns[k][i]) * s;
  return q;
}

Affine3d rigid_map(const DualQuaternion& sum) {
  constexpr double kVanished = 1e-20;  // square of GF_MIN_VECTOR_LENGTH
  const Quaternion &r = sum.real, &d = sum.dual;
  const double square = dot(r, r);
  if (square < kVanished) return {};
  const auto rotated = [&](const Vec3d& p) {
    return p + cross(r.v, cross(r.v, p) + p * r.w) * (2.0 / square);
  };
  // The vector part of 2 d conj(r).
  const Vec3d translation = (d.v * r.w - r.v * d.w + cross(r.v, d.v)) * (2.0 / square);
  return {rotated({1, 0, 0}), rotated({0, 1, 0}), rotated({0, 0, 1}), translation};
}

std::optional<PolarParts> polar_parts(const Affine3d& map) {
  const double determinant = map.determinant();
  if (!(std::abs(determinant) >= kSmallestVolume)) return std::nullopt;
  const Affine3d linear = linear_part(map);
  PolarParts parts;
  parts.rotation = orthogonal_factor(linear);
  if (determinant < 0.0) parts.rotation = {-parts.rotation.x, -parts.rotation.y, -parts.rotation.z, {}};
  parts.stretch = transpose(parts.rotation) * linear;
  return parts;
}

}  // namespace msbvh::translate
