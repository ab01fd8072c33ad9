// Whose the bytes of a scene are.
#include <doctest/doctest.h>

#include "core/plan/effect_bytes.h"
#include "tests/unit/still_scene.h"

namespace msbvh {
namespace {

TEST_CASE("bytes of effects: a still triangle is all base") {
  const EffectBytes bytes = effect_bytes(still_scene());
  CHECK(bytes.base == 3 * sizeof(Vec3f) + sizeof(Triangle));
  CHECK(bytes.total() == bytes.base);
}

TEST_CASE("bytes of effects: keys after the first deform, controls between keys are the polynomial's") {
  Scene scene = still_scene();
  scene.meshes = {triangle("/moving", 4)};
  scene.meshes[0].shape.degree = 3;
  const EffectBytes bytes = effect_bytes(scene);
  const std::uint64_t key = 3 * sizeof(Vec3f);
  CHECK(bytes.base == key + sizeof(Triangle));
  CHECK(bytes[Effect::kDeformingKeys] == 4 * key);
  CHECK(bytes[Effect::kPolynomialMotion] == 8 * key);
  CHECK(bytes.total() == scene.meshes[0].shape.position_count() * sizeof(Vec3f) + sizeof(Triangle));
}

TEST_CASE("bytes of effects: what brings a shape has its first key") {
  Scene scene = still_scene();
  scene.meshes[0].cage_faces = 1;
  scene.points.resize(1);
  scene.points[0].shape.point_count = 5;
  scene.points[0].shape.segments = 2;
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/a", 0, 1, std::vector<Affine3f>(6), {}}};
  const EffectBytes bytes = effect_bytes(scene);
  CHECK(bytes.base == 0);
  CHECK(bytes[Effect::kSubdivision] == 3 * sizeof(Vec3f) + sizeof(Triangle));
  CHECK(bytes[Effect::kPoints] == 5 * sizeof(RoundVertex));
  CHECK(bytes[Effect::kDeformingKeys] == 10 * sizeof(RoundVertex));
  CHECK(bytes[Effect::kInstances] == 3 * sizeof(Affine3f));
  CHECK(bytes[Effect::kMovingInstances] == 3 * sizeof(Affine3f));
}

}  // namespace
}  // namespace msbvh
