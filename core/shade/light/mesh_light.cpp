#include "core/shade/light/mesh_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/shade/world_triangle.h"

namespace msbvh {
namespace {

// Of the mean, that a triangle without an area at any control counts as, if the mesh moves: between them it
// may have one.
constexpr double kLeastShare = 1e-3;
// Roundings of 2^-24, relative to the largest coordinate and the distance, by which a shadow ray's end may
// be off beside the margin of the triangle: its direction is rounded thrice, its length twice, and so are
// the places that it leads from and to.
constexpr float kEndError = 8 * 0x1p-24f;
// Cosine below which a light is seen edge-on: nothing of it would be left before that end.
constexpr float kEdgeOn = 1e-5f;

double triangle_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 0.5 * length(cross(b - a, c - a));
}

std::vector<double> mean_areas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.triangles.size());
  const std::uint32_t controls = mesh.form().controls();
  for (std::uint32_t control = 0; control < controls; ++control) {
    const Vec3f* at = mesh.control_positions(control);
    for (std::size_t i = 0; i < areas.size(); ++i) {
      const Triangle& t = mesh.triangles[i];
      areas[i] += triangle_area(Vec3d(at[t[0]]), Vec3d(at[t[1]]), Vec3d(at[t[2]])) / controls;
    }
  }
  return areas;
}

HitSource source_of(const Scene& scene, const LightSurface& surface) {
  HitSource source;
  source.look = source.mesh = &scene.meshes[surface.mesh];
  if (surface.set == LightSurface::kNoSet) return source;
  source.instances = &scene.instances[surface.set];
  source.instance = surface.instance;
  source.prototype = &scene.prototypes[source.instances->prototype];
  return source;
}

}  // namespace

TriangleShares::TriangleShares(const TriangleMesh& mesh) {
  std::vector<double> areas = mean_areas(mesh);
  double sum = 0.0;
  for (const double area : areas) sum += area;
  const double least =
      mesh.segments > 0 ? kLeastShare * sum / double(std::max<std::size_t>(areas.size(), 1)) : 0.0;
  double all = 0.0;
  for (double& area : areas) all += area = std::max(area, least);
  double before = 0.0;
  for (const double area : areas)
    cumulative_.push_back(all > 0.0 ? static_cast<float>((before += area) / all) : 0.0f);
  if (all > 0.0) cumulative_.back() = 1.0f;
}

TriangleShares::Pick TriangleShares::pick(float random) const {
  const auto found = std::ranges::upper_bound(cumulative_, random) - cumulative_.begin();
  const auto last = static_cast<std::ptrdiff_t>(cumulative_.size()) - 1;
  const auto triangle = static_cast<std::uint32_t>(std::min(found, last));
  const float before = triangle > 0 ? cumulative_[triangle - 1] : 0.0f, own = share(triangle);
  return {triangle, own > 0.0f ? std::clamp((random - before) / own, 0.0f, 0x1.fffffep-1f) : 0.0f};
}

MeshLight::MeshLight(const Scene& scene, const Light& light, std::shared_ptr<const TriangleShares> shares)
    : light_(&light),
      source_(source_of(scene, light.surface)),
      shares_(std::move(shares)),
      met_(light.shadow == LightShadow{} && light.shadow_groups.empty()) {}

bool MeshLight::is_shown(float time) const {
  float local = time;
  return (!source_.prototype || source_.prototype->time_remap.at(time, local)) &&
         (!source_.instances || source_.instances->time_remap.at(time, local));
}

bool MeshLight::sample(const SurfaceHit& surface, const LightValues& values, float time, Point2 random,
                       LightSample& sample) const {
  if (values.radiance == Vec3f{} || !is_shown(time)) return false;
  const TriangleShares::Pick pick = shares_->pick(random.x);
  const float share = shares_->share(pick.triangle);
  if (!(share > 0.0f)) return false;
  const WorldTriangle t = world_triangle(source_, instance_pose(source_, time), pick.triangle, time);
  const Vec3d x = t.vertex[1] - t.vertex[0], y = t.vertex[2] - t.vertex[0], across = cross(x, y);
  const double root = std::sqrt(double(pick.within)), v = double(random.y) * root;
  const Vec3d place = t.vertex[0] + x * (1.0 - root) + y * v;
  const Vec3d from(surface.position), to_light = place - from;
  const double distance = length(to_light), doubled_area = length(across);
  const double cosine = std::abs(dot(across, to_light)) / (distance * doubled_area);
  if (!(cosine > kEdgeOn && doubled_area > 0.0)) return false;  // NaN too
  const double solid_angle = 0.5 * doubled_area / share * cosine / (distance * distance);
  if (!(solid_angle < std::numeric_limits<float>::max())) return false;
  sample.direction = Vec3f(to_light * (1.0 / distance));
  const Vec3f size = max(abs(surface.position), abs(Vec3f(place)));
  const Vec3d start(leave(surface, sample.direction, time).org);  // on either side
  const double off =
      length(start - from) + t.margin + kEndError * (double(std::max({size.x, size.y, size.z})) + distance);
  sample.distance = static_cast<float>(std::max(distance - off / cosine, 0.0));
  sample.irradiance = values.radiance * static_cast<float>(solid_angle);
  sample.pdf = met_ ? static_cast<float>(1.0 / solid_angle) : 0.0f;
  sample.casts_shadow = true;
  sample.diffuse = values.diffuse;
  sample.specular = values.specular;
  return true;
}

float MeshLight::pdf(const Vec3f& direction, const Hit& hit, float time) const {
  const WorldTriangle t = world_triangle(source_, instance_pose(source_, time), hit.triangle, time);
  const Vec3d across = cross(t.vertex[1] - t.vertex[0], t.vertex[2] - t.vertex[0]);
  const double doubled_area = length(across), facing = std::abs(dot(across, Vec3d(direction)));
  if (!(facing > kEdgeOn * doubled_area)) return 0.0f;
  const double distance = hit.t;
  return static_cast<float>(2.0 * distance * distance * shares_->share(hit.triangle) / facing);
}

Box3f MeshLight::bounds() const {
  const TriangleMesh& mesh = source_.mesh->shape;
  Box3f own, world;
  for (std::size_t i = 0; i < mesh.position_count(); ++i) own.grow(mesh.positions[i]);
  if (own.empty() || !source_.instances) return own;
  for (const Affine3f& m : source_.instance_controls()) {
    for (int corner = 0; corner < 8; ++corner) {
      world.grow(m.point({corner & 1 ? own.hi.x : own.lo.x, corner & 2 ? own.hi.y : own.lo.y,
                          corner & 4 ? own.hi.z : own.lo.z}));
    }
  }
  return world;
}

double MeshLight::area(float time) const {
  const std::optional<InstancePose> pose = instance_pose(source_, time);
  double sum = 0.0;
  for (std::uint32_t i = 0; i < source_.mesh->shape.triangles.size(); ++i) {
    const WorldTriangle t = world_triangle(source_, pose, i, time);
    sum += triangle_area(t.vertex[0], t.vertex[1], t.vertex[2]);
  }
  return sum;
}

}  // namespace msbvh
