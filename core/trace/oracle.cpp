#include "core/trace/oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/trace/pose.h"
#include "core/trace/verdict.h"

namespace msbvh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Vec2d {
  double x, y;
};
double cross2(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }
constexpr double kRounding = 0x1p-53;
// What a product loses in single precision below its smallest number, and what is so far above it that
// rounding loses more.
constexpr double kUnderflow = 0x1p-148, kNoUnderflow = 0x1p-100;
constexpr double kLeastArea = 0x1p-126;  // whose reciprocal is finite

// What double precision loses of cross2(): each product and the difference are rounded once, and so are the
// coordinates that go in, after two roundings of terms no larger than `size`.
double lost_of_cross2(const Vec2d& a, const Vec2d& b, double size) {
  const double products = std::abs(a.x * b.y) + std::abs(a.y * b.x);
  const double inputs = size * (std::abs(a.x) + std::abs(a.y) + std::abs(b.x) + std::abs(b.y));
  return kRounding * (2.0 * products + 4.0 * inputs) + 4.0 * kUnderflow;
}

double distance_to_segment(const Vec2d& a, const Vec2d& b) {
  const Vec2d e{b.x - a.x, b.y - a.y};
  const double l2 = e.x * e.x + e.y * e.y;
  const double s = l2 > 0.0 ? std::clamp(-(a.x * e.x + a.y * e.y) / l2, 0.0, 1.0) : 0.0;
  return std::hypot(a.x + s * e.x, a.y + s * e.y);
}

// The triangle sheared along the ray, as Woop et al. do, so that the ray becomes the origin of a plane.
class ShearedTriangle {
 public:
  // `size`: of the largest coordinate that the vertices were interpolated from.
  ShearedTriangle(const RayD& ray, const std::array<Vec3d, 3>& vertices, double size) {
    const Vec3d a = abs(ray.dir);
    const int kz = a.z >= a.x && a.z >= a.y ? 2 : (a.y >= a.x ? 1 : 0), kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    size = std::max(size, largest_coordinate(ray.org));
    for (int i = 0; i < 3; ++i) {
      const Vec3d v = vertices[i] - ray.org;
      const double z = v[kz] / ray.dir[kz];
      p_[i] = {v[kx] - ray.dir[kx] * z, v[ky] - ray.dir[ky] * z};
      t_[i] = z;
    }
    size_ = size;
    error_ = ray.error + kOracleError * size;
    t_error_ = error_ / std::abs(ray.dir[kz]);
  }

  Verdict judge() const {
    const double w[3] = {cross2(p_[1], p_[2]), cross2(p_[2], p_[0]), cross2(p_[0], p_[1])};
    const double area = w[0] + w[1] + w[2];
    Verdict verdict;
    verdict.hit =
        area != 0.0 && ((w[0] >= 0 && w[1] >= 0 && w[2] >= 0) || (w[0] <= 0 && w[1] <= 0 && w[2] <= 0));
    const double edge = std::min({distance_to_segment(p_[0], p_[1]), distance_to_segment(p_[1], p_[2]),
                                  distance_to_segment(p_[2], p_[0])});
    // Of a triangle far away, or in a line with the ray, all weights may have one sign by rounding alone. No
    // hit is lost: corners of what is hit lie no farther from the ray than its edges are long, so that signs
    // are out of doubt by 2^30.
    const double lost_weights[3] = {lost_of_cross2(p_[1], p_[2], size_), lost_of_cross2(p_[2], p_[0], size_),
                                    lost_of_cross2(p_[0], p_[1], size_)};
    const bool decided = std::abs(w[0]) > lost_weights[0] && std::abs(w[1]) > lost_weights[1] &&
                         std::abs(w[2]) > lost_weights[2];
    verdict.clear = verdict.hit && edge > error_ && decided;
    verdict.possible = verdict.hit || edge <= error_;
    if (!verdict.possible) return verdict;
    const double t_min = std::min({t_[0], t_[1], t_[2]}), t_max = std::max({t_[0], t_[1], t_[2]});
    const double lost = lost_to_underflow(area);
    verdict.t_lo = t_min - t_error_ - lost;
    verdict.t_hi = t_max + t_error_ + lost;
    if (std::abs(area) <= lost_weights[0] + lost_weights[1] + lost_weights[2]) return verdict;
    verdict.u = w[1] / area;
    verdict.v = w[2] / area;
    verdict.t = (w[0] * t_[0] + w[1] * t_[1] + w[2] * t_[2]) / area;
    // What vertices err by may flatten it to a line, as a kernel sees it: it may be met anywhere along that.
    if (std::abs(area) <= 2.0 * error_ * longest_edge()) return verdict;
    const double slack = t_error_ + slope(area) * error_ + lost;
    verdict.t_lo = std::max(verdict.t_lo, std::min(verdict.t, t_max) - slack);
    verdict.t_hi = std::min(verdict.t_hi, std::max(verdict.t, t_min) + slack);
    return verdict;
  }

 private:
  // How fast t changes as the ray moves sideways: steep where the triangle is seen edge-on.
  double slope(double area) const {
    const Vec2d e1{p_[1].x - p_[0].x, p_[1].y - p_[0].y}, e2{p_[2].x - p_[0].x, p_[2].y - p_[0].y};
    const double d1 = t_[1] - t_[0], d2 = t_[2] - t_[0];
    return std::hypot(d1 * e2.y - d2 * e1.y, d2 * e1.x - d1 * e2.x) / std::abs(area);
  }

  double longest_edge() const {
    double most = 0.0;
    for (int i = 0; i < 3; ++i) {
      const Vec2d &a = p_[i], &b = p_[(i + 1) % 3];
      most = std::max(most, std::hypot(b.x - a.x, b.y - a.y));
    }
    return most;
  }

  // By how much a kernel's distance may be off because its weights, or their products with distances, are too
  // small for single precision: 0 but for triangles that are tiny seen from the ray's origin.
  double lost_to_underflow(double area) const {
    double across = 0.0, along = 0.0;
    for (int i = 0; i < 3; ++i) {
      across = std::max({across, std::abs(p_[i].x), std::abs(p_[i].y)});
      along = std::max(along, std::abs(t_[i]));
    }
    if (across * across * std::min(1.0, along) >= kNoUnderflow) return 0.0;
    if (std::abs(area) < kLeastArea) return kInfinity;
    return kUnderflow * (4.0 + 4.0 * along) / std::abs(area);
  }

  Vec2d p_[3];
  double t_[3];
  double size_, error_, t_error_;
};

Vec3d point_at(const GridMesh& mesh, const Grid& grid, const GridVertex& v, double u) {
  return track_at(mesh.form(), u,
                  [&](std::uint32_t c) { return Vec3d(mesh.control_point(grid, v.row, v.column, c)); });
}

using Id = PrimitiveId;
using Visitor = VerdictVisitor;

void visit_meshes(const Bvh& bvh, const RayD& ray, double u, std::uint32_t instance, const Visitor& visit) {
  for (std::uint32_t m = 0; m < bvh.meshes.size(); ++m) {
    const TriangleMesh& mesh = *bvh.meshes[m];
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle& t = mesh.triangles[i];
      const double size = largest_control(mesh.form(), u, [&](std::uint32_t c) {
        const Vec3f* p = mesh.control_positions(c);
        return std::max({largest_coordinate(Vec3d(p[t[0]])), largest_coordinate(Vec3d(p[t[1]])),
                         largest_coordinate(Vec3d(p[t[2]]))});
      });
      const ShearedTriangle sheared(
          ray, {vertex_at(mesh, t[0], u), vertex_at(mesh, t[1], u), vertex_at(mesh, t[2], u)}, size);
      const Verdict verdict = sheared.judge();
      if (verdict.possible) visit({instance, {GeometryKind::kTriangleMesh, m}, i}, verdict);
    }
  }
  for (std::uint32_t m = 0; m < bvh.grids.size(); ++m) {
    const GridMesh& mesh = *bvh.grids[m];
    for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
      const GridTriangle t = mesh.triangle(i);
      const Grid& grid = mesh.grids[t.grid];
      const auto v = vertices_of(t);
      const double size = largest_control(mesh.form(), u, [&](std::uint32_t c) {
        double most = 0.0;
        for (const GridVertex& corner : v)
          most = std::max(most,
                          largest_coordinate(Vec3d(mesh.control_point(grid, corner.row, corner.column, c))));
        return most;
      });
      const ShearedTriangle sheared(
          ray, {point_at(mesh, grid, v[0], u), point_at(mesh, grid, v[1], u), point_at(mesh, grid, v[2], u)},
          size);
      const Verdict verdict = sheared.judge();
      if (verdict.possible) visit({instance, {GeometryKind::kGridMesh, m}, i}, verdict);
    }
  }
}

void visit_all(const Bvh& bvh, const Ray& ray, const Visitor& visit) {
  const double u = std::clamp(double(ray.time), 0.0, 1.0);
  const RayD in_world{Vec3d(ray.org), Vec3d(ray.dir), 0.0, ray.tnear, ray.tfar};
  visit_meshes(bvh, in_world, u, kNoInstance, visit);
  judge_round(bvh, in_world, u, kNoInstance, visit);
  for (std::uint32_t i = 0; i < bvh.instances.size(); ++i) {
    const Instance& instance = bvh.instances[i];
    const std::optional<double> own = local_time(bvh.time_remap_of(instance), u);
    const std::optional<double> inside = local_time(&instance.object->time_remap, u);
    if (!own || !inside) continue;
    const Affine3d world_from_object = map_at(bvh, instance, *own);
    if (world_from_object.determinant() == 0.0) continue;
    const Affine3d m = inverse(world_from_object);
    // The map's elements, the origin and their product err by a share of the terms that the transform adds
    // up.
    const Vec3d terms = abs(m.x) * std::abs(double(ray.org.x)) + abs(m.y) * std::abs(double(ray.org.y)) +
                        abs(m.z) * std::abs(double(ray.org.z)) + abs(m.t);
    const RayD local{m.point(Vec3d(ray.org)), m.vector(Vec3d(ray.dir)),
                     kOracleError * std::max({terms.x, terms.y, terms.z}), ray.tnear, ray.tfar};
    visit_meshes(*instance.object, local, *inside, i, visit);
    judge_round(*instance.object, local, *inside, i, visit);
  }
}

std::string describe(const Id& id) {
  std::ostringstream s;
  if (id.instance != kNoInstance) s << "instance " << id.instance << " ";
  constexpr const char* kKinds[][2] = {
      {"mesh", "triangle"}, {"grids", "triangle"}, {"curves", "span"}, {"points", "point"}};
  const auto& [set, part] = kKinds[static_cast<std::size_t>(id.geometry.kind())];
  s << set << " " << id.geometry.index() << " " << part << " " << id.triangle;
  return s.str();
}

// A span is looked at in many parts.
constexpr double kTestsPerSpan = 1000.0;

}  // namespace

double oracle_tests_per_ray(const Bvh& bvh) {
  double sum = 0.0;
  for (const auto& set : bvh.points) sum += static_cast<double>(set->point_count);
  for (const auto& set : bvh.curves) sum += kTestsPerSpan * static_cast<double>(set->span_count());
  for (const auto& mesh : bvh.grids) sum += static_cast<double>(mesh->triangle_count());
  for (const auto& mesh : bvh.meshes) sum += static_cast<double>(mesh->triangles.size());
  for (const Instance& instance : bvh.instances) sum += oracle_tests_per_ray(*instance.object);
  return sum;
}

std::optional<std::string> judge_intersection(const Bvh& bvh, const Ray& ray, const std::optional<Hit>& hit) {
  std::ostringstream wrong;
  wrong.precision(9);
  bool answered = !hit.has_value();
  visit_all(bvh, ray, [&](const Id& id, const Verdict& v) {
    if (hit && id == Id{hit->instance, hit->geometry, hit->triangle}) {
      answered = true;
      if (hit->t < v.t_lo || hit->t > v.t_hi) {
        wrong << describe(id) << " was hit at t = " << hit->t << "; expected " << v.t << " in [" << v.t_lo
              << ", " << v.t_hi << "]. ";
      }
      return;
    }
    const double limit = hit ? hit->t : ray.tfar;
    if (v.clear && v.t_lo > ray.tnear && v.t_hi < limit) {
      wrong << describe(id) << " lies at t = " << v.t << ", before " << limit << ", and was not found. ";
    }
  });
  if (!answered)
    wrong << describe({hit->instance, hit->geometry, hit->triangle}) << " was hit; the ray misses it. ";
  const std::string text = wrong.str();
  return text.empty() ? std::nullopt : std::optional(text);
}

std::optional<std::string> judge_distance(const Bvh& bvh, const Ray& ray, float t) {
  const bool found = !std::isinf(t);
  bool answered = !found;
  std::ostringstream wrong;
  wrong.precision(9);
  visit_all(bvh, ray, [&](const Id& id, const Verdict& v) {
    answered |= v.t_lo <= t && t <= v.t_hi;
    const double limit = found ? t : ray.tfar;
    if (v.clear && v.t_lo > ray.tnear && v.t_hi < limit)
      wrong << describe(id) << " lies at t = " << v.t << ", before " << limit << ", and was not found. ";
  });
  if (!answered) wrong << "a hit at t = " << t << ", where nothing lies. ";
  const std::string text = wrong.str();
  return text.empty() ? std::nullopt : std::optional(text);
}

std::optional<std::string> judge_occlusion(const Bvh& bvh, const Ray& ray, bool occluded) {
  bool clear = false, possible = false;
  visit_all(bvh, ray, [&](const Id&, const Verdict& v) {
    clear |= v.clear && v.t_lo > ray.tnear && v.t_hi < ray.tfar;
    possible |= v.t_hi >= ray.tnear && v.t_lo <= ray.tfar;
  });
  if (occluded && !possible) return "occluded, but nothing lies on the ray";
  if (!occluded && clear) return "not occluded, but something lies on the ray";
  return std::nullopt;
}

}  // namespace msbvh
