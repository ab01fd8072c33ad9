#include "core/shade/point_motion.h"

#include <array>
#include <cstddef>
#include <utility>

namespace msbvh {
namespace {

template <typename T>
Moving<T> per_shutter(const Moving<T>& own, double rate) {
  return {own.value, own.rate * rate};
}

// Of three vertices' tracks, by their weights.
template <typename VertexControl>
Moving<Vec3d> on_triangle(const VertexControl& control, const Hit& hit, const TrackForm& form, float time,
                          Side side) {
  const double weights[] = {1.0 - double(hit.u) - double(hit.v), double(hit.u), double(hit.v)};
  Moving<Vec3d> point;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto of_corner = [&](std::uint32_t c) { return Vec3d(control(corner, c)); };
    const Moving<Vec3d> vertex = moving_value(of_corner, form, time, side);
    point.value += vertex.value * weights[corner];
    point.rate += vertex.rate * weights[corner];
  }
  return point;
}

Moving<Vec3d> on_curve(const CurveSet& shape, const Hit& hit, float time, Side side) {
  std::array<Moving<Vec3d>, kSpanVertices> vertices;
  for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
    const auto control = [&](std::uint32_t c) {
      return Vec3d(shape.control_vertices(c)[shape.spans[hit.triangle] + i].p);
    };
    vertices[i] = moving_value(control, shape.form(), time, side);
  }
  const double u = hit.u;
  return {bezier([&](std::uint32_t i) { return vertices[i].value; }, kSpanVertices - 1, u),
          bezier([&](std::uint32_t i) { return vertices[i].rate; }, kSpanVertices - 1, u)};
}

// In the geometry's space and its own time.
Moving<Vec3d> in_object(const HitSource& source, const Hit& hit, float time, Side side) {
  if (source.curves) return on_curve(source.curves->shape, hit, time, side);
  if (source.points) {
    const PointSet& shape = source.points->shape;
    const auto control = [&](std::uint32_t c) { return Vec3d(shape.control_vertices(c)[hit.triangle].p); };
    return moving_value(control, shape.form(), time, side);
  }
  if (source.grids) {
    const GridMesh& shape = source.grids->shape;
    const GridTriangle triangle = shape.triangle(hit.triangle);
    const auto v = vertices_of(triangle);
    const auto control = [&](std::size_t corner, std::uint32_t c) {
      return shape.control_point(shape.grids[triangle.grid], v[corner].row, v[corner].column, c);
    };
    return on_triangle(control, hit, shape.form(), time, side);
  }
  const TriangleMesh& shape = source.mesh->shape;
  const Triangle& v = shape.triangles[hit.triangle];
  const auto control = [&](std::size_t corner, std::uint32_t c) {
    return shape.control_positions(c)[v[corner]];
  };
  return on_triangle(control, hit, shape.form(), time, side);
}

// An affine map that moves.
struct MovingMap {
  Moving<Vec3d> x, y, z, t;

  Affine3d value() const { return {x.value, y.value, z.value, t.value}; }
  Affine3d rate() const { return {x.rate, y.rate, z.rate, t.rate}; }
};

template <typename Controls>
MovingMap moving_map(const Controls& controls, const TrackForm& form, const TimeRemap& remap, float time,
                     Side side) {
  const Moving<double> local = moving_time(remap, time, side);
  const auto column = [&](Vec3f Affine3f::*member) {
    const auto control = [&](std::uint32_t c) { return Vec3d(controls[c].*member); };
    return per_shutter(moving_value(control, form, static_cast<float>(local.value), side), local.rate);
  };
  return {column(&Affine3f::x), column(&Affine3f::y), column(&Affine3f::z), column(&Affine3f::t)};
}

// Likewise of numbers.
template <typename Controls, typename Number>
Moving<double> moving_number(const Controls& controls, Number member, const TrackForm& form,
                             const Moving<double>& local, Side side) {
  const auto control = [&](std::uint32_t c) { return double(controls[c].*member); };
  return per_shutter(moving_value(control, form, static_cast<float>(local.value), side), local.rate);
}

// (a - b) / (c - b), as it changes.
Moving<double> share(const Moving<double>& a, const Moving<double>& b, const Moving<double>& c) {
  const double whole = c.value - b.value, part = a.value - b.value;
  return {part / whole, ((a.rate - b.rate) * whole - part * (c.rate - b.rate)) / (whole * whole)};
}

// Of a point in camera space, in the window's unit.
bool project(const Camera& camera, const Moving<Vec3d>& p, Moving<double>& x, Moving<double>& y) {
  if (camera.projection == Projection::kOrthographic) {
    x = {p.value.x, p.rate.x};
    y = {p.value.y, p.rate.y};
    return true;
  }
  const double depth = -p.value.z, depth_rate = -p.rate.z;
  if (!(depth > 0.0)) return false;
  x = {p.value.x / depth, (p.rate.x * depth - p.value.x * depth_rate) / (depth * depth)};
  y = {p.value.y / depth, (p.rate.y * depth - p.value.y * depth_rate) / (depth * depth)};
  return true;
}

}  // namespace

Moving<Vec3d> point_in_world(const HitSource& source, const Hit& hit, const Vec3d& offset, float time,
                             Side side) {
  static const TimeRemap shutter;
  const TimeRemap& own = source.prototype ? source.prototype->time_remap : shutter;
  const Moving<double> local = moving_time(own, time, side);
  const Moving<Vec3d> object =
      per_shutter(in_object(source, hit, static_cast<float>(local.value), side), local.rate);
  Moving<Vec3d> world = object;
  if (source.instances) {
    const MovingMap map = moving_map(source.instance_controls(), source.instances->form(),
                                     source.instances->time_remap, time, side);
    world.value = map.value().point(object.value);
    world.rate = map.value().vector(object.rate) + map.rate().point(object.value);
  }
  if (source.curves || source.points) world.value += offset;
  return world;
}

bool point_on_screen(const Camera& camera, const Moving<Vec3d>& world, float time, Side side,
                     std::uint32_t width, std::uint32_t height, Moving<ScreenPoint>& screen) {
  const TrackForm form = camera.form();
  const MovingMap map = moving_map(camera.world_from_camera, form, camera.time_remap, time, side);
  const Affine3d camera_from_world = inverse(map.value());
  Moving<Vec3d> p;
  p.value = camera_from_world.point(world.value);
  p.rate = camera_from_world.vector(world.rate - map.rate().point(p.value));
  Moving<double> x, y;
  if (!project(camera, p, x, y)) return false;
  const Moving<double> local = moving_time(camera.time_remap, time, side);
  const auto edge = [&](float ScreenWindow::*member) {
    return moving_number(camera.window, member, form, local, side);
  };
  x = share(x, edge(&ScreenWindow::left), edge(&ScreenWindow::right));
  y = share(y, edge(&ScreenWindow::bottom), edge(&ScreenWindow::top));
  screen.value = {x.value * width, y.value * height};
  screen.rate = {x.rate * width, y.rate * height};
  return true;
}

Vec3d point_in_camera(const Camera& camera, const Vec3d& world, float time) {
  const MovingMap map =
      moving_map(camera.world_from_camera, camera.form(), camera.time_remap, time, Side::kAfter);
  return inverse(map.value()).point(world);
}

}  // namespace msbvh
