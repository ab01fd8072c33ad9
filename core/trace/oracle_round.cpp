// The oracle's part for curves and points, in double precision, by brute force.
#include "core/trace/oracle_round.h"

namespace msbvh {
namespace {

Verdict judge_point(const RayD& ray, const RoundD& ball, double largest_control) {
  const double l = length(ray.dir), size = std::max(largest_control, largest_coordinate(ray.org));
  const double error = ray.error + kOracleError * size;
  const Vec3d d = ray.dir * (1.0 / l), to = ball.p - ray.org;
  const double along = dot(to, d), aside = length(to - d * along);
  Answers answers(ray);
  if (aside > ball.radius + error || ball.radius <= 0.0) return answers.verdict();
  const double least = half_chord(std::max(0.0, ball.radius - error), aside + error);
  const double most = half_chord(ball.radius + error, std::max(0.0, aside - error));
  const double middle = 0.5 * (least + most), slack = (0.5 * (most - least) + error) / l;
  const bool clear = aside < ball.radius - error;
  answers.add(clear, (along - middle) / l, slack);
  answers.add(clear, (along + middle) / l, slack);
  return answers.verdict();
}

}  // namespace

void judge_round(const Bvh& bvh, const RayD& ray, double u, std::uint32_t instance,
                 const VerdictVisitor& visit) {
  if (!(length(ray.dir) > 0.0)) return;
  for (std::uint32_t s = 0; s < bvh.points.size(); ++s) {
    const PointSet& points = *bvh.points[s];
    for (std::uint32_t i = 0; i < points.point_count; ++i) {
      const Verdict verdict = judge_point(ray, vertex_at(points, i, u), size_at(points, i, u));
      if (verdict.possible) visit({instance, {GeometryKind::kPoints, s}, i}, verdict);
    }
  }
  for (std::uint32_t s = 0; s < bvh.curves.size(); ++s) {
    const CurveSet& curves = *bvh.curves[s];
    for (std::uint32_t i = 0; i < curves.span_count(); ++i) {
      const Verdict verdict = judge_span(ray, curves, i, u);
      if (verdict.possible) visit({instance, {GeometryKind::kCurves, s}, i}, verdict);
    }
  }
}

}  // namespace msbvh
