// delegate/translate/frame: implicit prims, as meshes of as many sides as they are seen to need.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <string>
#include <vector>

#include "delegate/translate/frame/assemble.h"
#include "delegate/translate/frame/frame_implicit.h"
#include "delegate/translate/frame/motions.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class NoTextures : public TextureSource {
 public:
};

ImplicitFrameInput sphere(double radius) { return {{"/ball", ImplicitKind::kSphere, "Z", {{radius}}}}; }

AssembledFrame assembled(const ImplicitFrameInput& input, double distance) {
  FrameShape shape;
  shape.mesh.path = input.shape.path;
  shape.motion = SampledMotion::still(testing::row_vector_matrix(testing::translation({0, 0, 0})));
  shape.implicit = input;
  FrameInput frame;
  frame.camera = testing::camera_at({0, 0, distance});
  frame.shutter = {-0.25, 0.25};
  FrameGroup group;
  group.shapes.push_back(shape);
  frame.groups.push_back(group);
  return assemble_frame(frame, testing::settings_of(), NoTextures());
}

std::size_t triangles(const AssembledFrame& frame) {
  return frame.scene->meshes.front().shape.triangles.size();
}

}  // namespace

TEST_CASE("a sphere that is seen closer has more sides, on its radius") {
  const AssembledFrame close = assembled(sphere(2.0), 6.0), far = assembled(sphere(2.0), 400.0);
  REQUIRE(close.scene->meshes.size() == 1);
  CHECK(close.diagnostics.empty());
  CHECK(triangles(close) > 4 * triangles(far));
}

TEST_CASE("points of an implicit prim lie on it at every time of its parameters") {
  ImplicitFrameInput grows = sphere(1.0);
  grows.times01 = {0.0, 1.0};
  grows.shape.values = {{1.5}, {1.0}, {2.0}};
  std::vector<Diagnostic> said;
  PrimLog log(said, "/ball");
  std::optional<FrameImplicit> implicit = FrameImplicit::make(grows, log);
  REQUIRE(implicit);
  TransformSamples still;
  still.times01 = {0.0};
  still.matrices = {testing::row_vector_matrix(testing::translation({0, 0, 0}))};
  MeshInput mesh;
  implicit->form(still, PixelSize::uniform(0.01), mesh);
  REQUIRE(mesh.points.samples.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double radius = i == 0 ? 1.0 : 2.0;
    CHECK(mesh.points.samples[i].time01 == double(i));
    for (const Vec3f& point : mesh.points.samples[i].values)
      CHECK(std::abs(double(length(point)) - radius) < 1e-6);
  }
  CHECK(mesh.computed_normals == Normals::kSmooth);
  CHECK(mesh.stray > 0.0);
  CHECK(mesh.stray * 100.0 <= 0.1);  // a tenth of a pixel of a hundredth
  CHECK(implicit->box().hi.x == doctest::Approx(2.0));
}

TEST_CASE("a parameter that is no number leaves its prim out, with an error that names it") {
  const AssembledFrame frame = assembled(sphere(std::numeric_limits<double>::quiet_NaN()), 6.0);
  CHECK(frame.scene->meshes.empty());
  REQUIRE_FALSE(frame.diagnostics.empty());
  CHECK(frame.diagnostics.front().severity == Severity::kError);
  CHECK(frame.diagnostics.front().path == "/ball");
  CHECK(frame.diagnostics.front().attribute == "radius");
}
