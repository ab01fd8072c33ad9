// A mesh that shines: places on it are sampled evenly by area, triangle by triangle, where they are at the
// time. A scattered ray finds it as it finds any surface, by tracing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/box.h"
#include "core/scene/scene.h"
#include "core/shade/light/light.h"
#include "core/shade/scene_index.h"
#include "core/shade/surface_hit.h"

namespace msbvh {

// How likely each triangle of a mesh is to be sampled, at all times and in all places of the mesh: by its
// mean area over the controls. None that has an area at some time is left out.
class TriangleShares {
 public:
  explicit TriangleShares(const TriangleMesh& mesh);

  struct Pick {
    std::uint32_t triangle;
    float within;  // what is left of the random number, in [0, 1)
  };
  Pick pick(float random) const;
  float share(std::uint32_t triangle) const {
    return cumulative_[triangle] - (triangle > 0 ? cumulative_[triangle - 1] : 0.0f);
  }

 private:
  std::vector<float> cumulative_;  // ends at 1
};

class MeshLight {
 public:
  // Keeps pointers into the scene.
  MeshLight(const Scene& scene, const Light& light, std::shared_ptr<const TriangleShares> shares);

  const Light& light() const { return *light_; }
  // Of what a ray has hit, which this is or not.
  const HitSource& source() const { return source_; }

  // False where it does not shine on the surface from the sampled place, or is hidden at the time. `sample`
  // gets the distance to just before the light's own surface, which is there for shadow rays too.
  bool sample(const SurfaceHit& surface, const LightValues& values, float time, Point2 random,
              LightSample& sample) const;
  // Whether sample() has a density, which a scattered ray's can be weighed against: not where shadow rays
  // obey settings, by which the light may be seen through what hides it from a scattered ray.
  bool is_met() const { return met_; }
  // Leaves it to sample(): the mesh is met as another light's.
  void sample_alone() { met_ = false; }
  // The density of sample() for a ray's direction, per steradian, where it has hit the light.
  float pdf(const Vec3f& direction, const Hit& hit, float time) const;

  // In the world, at all times.
  Box3f bounds() const;
  // Of all triangles at a time, one side.
  double area(float time) const;

 private:
  bool is_shown(float time) const;

  const Light* light_;
  HitSource source_;
  std::shared_ptr<const TriangleShares> shares_;
  bool met_;
};

}  // namespace msbvh
