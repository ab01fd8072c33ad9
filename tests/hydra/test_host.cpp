// The plugin in a host, by OpenUSD's scene delegate and by its scene indices. ctest sets PXR_PLUGINPATH_NAME.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <pxr/base/gf/vec3d.h>
#include <pxr/base/tf/diagnosticMgr.h>
#include <pxr/usd/sdf/layer.h>
#include <pxr/usd/usd/attribute.h>
#include <pxr/usd/usd/prim.h>
#include <pxr/usd/usdGeom/imageable.h>
#include <pxr/usd/usdGeom/xformable.h>
#include <string>

#include "tests/hydra/host.h"

using namespace msbvh::testing;
PXR_NAMESPACE_USING_DIRECTIVE

namespace {

constexpr std::uint32_t kSize = 64;

// A square of 2 x 2 in front of an orthographic camera that sees 8 x 8, for a shutter of half a frame. It
// moves 4 to the right in a frame.
constexpr const char* kShot = R"(#usda 1.0
(
    timeCodesPerSecond = 24
    upAxis = "Y"
)
def Camera "cam"
{
    token projection = "orthographic"
    float horizontalAperture = 80
    float verticalAperture = 80
    float2 clippingRange = (1, 100)
    double shutter:open = 0
    double shutter:close = 0.5
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Xform "moves"
{
    double3 xformOp:translate.timeSamples = { 0: (-2, 0, 0), 1: (2, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Mesh "square"
    {
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    }
}
)";

UsdStageRefPtr shot() {
  const SdfLayerRefPtr layer = SdfLayer::CreateAnonymous(".usda");
  REQUIRE(layer->ImportFromString(kShot));
  return UsdStage::Open(layer);
}

struct Rendering {
  explicit Rendering(Engine engine, int samples = 64)
      : stage(shot()), host(stage, engine, SdfPath("/cam"), kSize, kSize) {
    host.set("convergedSamplesPerPixel", VtValue(samples));
    host.set_time(0.0);
  }

  UsdStageRefPtr stage;
  Host host;
};

float alpha_at(const Picture& picture, std::uint32_t x, std::uint32_t y) {
  return picture.rgba[4 * (std::size_t(y) * picture.width + x) + 3];
}

// How much of the shutter the square covers a place for: it goes from [-3, -1] to [-1, 1].
double coverage(double x) {
  const double first = std::max(0.0, (x + 1.0) / 2.0), last = std::min(1.0, (x + 3.0) / 2.0);
  return std::max(0.0, last - first);
}

constexpr Engine kEngines[] = {Engine::kSceneDelegate, Engine::kSceneIndices};

}  // namespace

TEST_CASE("what moves covers what it passes for as long as it is there") {
  for (const Engine engine : kEngines) {
    CAPTURE(int(engine));
    Rendering rendering(engine, 256);
    rendering.host.converge();
    const Picture picture = rendering.host.picture();
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const double place = (x + 0.5) / kSize * 8.0 - 4.0;
      // Of 256 stratified times each place sees at most a few more or less, and a pixel is 1/16 of a way
      // wide.
      CHECK(std::abs(double(alpha_at(picture, x, kSize / 2)) - coverage(place)) < 0.05);
      CHECK(alpha_at(picture, x, 2) == 0.0f);
    }
  }
}

TEST_CASE("both engines of OpenUSD make the same picture") {
  Rendering first(Engine::kSceneDelegate), second(Engine::kSceneIndices);
  first.host.converge();
  second.host.converge();
  const Picture a = first.host.picture(), b = second.host.picture();
  for (std::size_t i = 0; i < a.rgba.size(); ++i) CHECK(std::abs(a.rgba[i] - b.rgba[i]) < 1e-3f);
}

TEST_CASE("an edit makes the picture of a fresh render, and only what it asks for") {
  for (const Engine engine : kEngines) {
    CAPTURE(int(engine));
    Rendering edited(engine);
    edited.host.converge();
    edited.stage->GetPrimAtPath(SdfPath("/cam"))
        .GetAttribute(TfToken("xformOp:translate"))
        .Set(GfVec3d(1, 0, 10));
    edited.host.converge();
    const VtDictionary stats = edited.host.stats();
    CHECK(VtDictionaryGet<std::int64_t>(stats, "treesBuilt") == 0);
    CHECK(VtDictionaryGet<std::int64_t>(stats, "treesRefitted") == 0);
    Rendering fresh(engine);
    fresh.stage->GetPrimAtPath(SdfPath("/cam"))
        .GetAttribute(TfToken("xformOp:translate"))
        .Set(GfVec3d(1, 0, 10));
    fresh.host.converge();
    // The edited one keeps its world's origin, so that places are rounded otherwise.
    const Picture kept = edited.host.picture(), alone = fresh.host.picture();
    for (std::size_t i = 0; i < kept.rgba.size(); ++i) CHECK(std::abs(kept.rgba[i] - alone.rgba[i]) < 0.02f);
    UsdGeomImageable(edited.stage->GetPrimAtPath(SdfPath("/moves"))).MakeInvisible();
    edited.host.converge();
    const Picture hidden = edited.host.picture();
    CHECK(std::all_of(hidden.prim_ids.begin(), hidden.prim_ids.end(), [](int id) { return id == -1; }));
  }
}

TEST_CASE("pause keeps samples, stop ends, restart begins again") {
  Rendering rendering(Engine::kSceneIndices, 100000);
  HdRenderDelegate& delegate = rendering.host.delegate();
  rendering.host.execute();
  CHECK(delegate.Pause());
  CHECK(delegate.IsPaused());
  CHECK(delegate.Resume());
  CHECK_FALSE(delegate.IsPaused());
  CHECK(delegate.Stop(true));
  CHECK(delegate.IsStopped());
  CHECK_FALSE(rendering.host.is_converged());
  rendering.host.execute();  // nothing was edited
  CHECK(delegate.IsStopped());
  CHECK(delegate.Restart());
  CHECK_FALSE(delegate.IsStopped());
}

TEST_CASE("a host that goes in the middle of a render waits for nothing") {
  for (const Engine engine : kEngines) {
    for (int i = 0; i < 20; ++i) {
      Rendering rendering(engine, 100000);
      rendering.host.execute();
    }
  }
}

TEST_CASE("two delegates at once") {
  Rendering a(Engine::kSceneIndices), b(Engine::kSceneIndices);
  a.host.execute();
  b.host.execute();
  a.host.converge();
  b.host.converge();
  CHECK(a.host.picture().rgba == b.host.picture().rgba);
}

TEST_CASE("bad points end in a warning, not in the host's end") {
  for (const Engine engine : kEngines) {
    Rendering rendering(engine, 4);
    const UsdPrim square = rendering.stage->GetPrimAtPath(SdfPath("/moves/square"));
    const float nan = std::nanf("");
    for (const VtVec3fArray& points :
         {VtVec3fArray{}, VtVec3fArray(2, GfVec3f(0.0f)), VtVec3fArray(4, GfVec3f(nan, 0.0f, 0.0f))}) {
      square.GetAttribute(TfToken("points")).Set(points);
      rendering.host.converge();
    }
    square.GetAttribute(TfToken("faceVertexIndices")).Set(VtIntArray{0, 1, 2, 99});
    rendering.host.converge();
  }
}

TEST_CASE("a prim of a kind that is not drawn is named, once") {
  struct Listener : TfDiagnosticMgr::Delegate {
    void IssueError(const TfError&) override {}
    void IssueFatalError(const TfCallContext&, const std::string&) override {}
    void IssueStatus(const TfStatus&) override {}
    void IssueWarning(const TfWarning& warning) override {
      told += warning.GetCommentary().find("type volume are not drawn") != std::string::npos;
    }
    int told = 0;
  } listener;
  TfDiagnosticMgr::GetInstance().AddDelegate(&listener);
  {
    const UsdStageRefPtr stage = shot();
    stage->DefinePrim(SdfPath("/smoke"), TfToken("Volume"));
    stage->DefinePrim(SdfPath("/fire"), TfToken("Volume"));
    Host host(stage, Engine::kSceneIndices, SdfPath("/cam"), kSize, kSize);
    host.set("convergedSamplesPerPixel", VtValue(4));
    host.set_time(0.0);
    host.converge();
  }
  TfDiagnosticMgr::GetInstance().RemoveDelegate(&listener);
  CHECK(listener.told == 1);
}
