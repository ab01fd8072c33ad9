// Random edits of a stage while the plugin renders: nothing fails, and what is there in the end is what a
// fresh host draws. MSBVH_EDITS sets how many (ctest: 400; 10,000 by hand).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <doctest/doctest.h>
#include <functional>
#include <pxr/base/gf/vec3d.h>
#include <pxr/base/gf/vec3f.h>
#include <pxr/base/tf/diagnosticMgr.h>
#include <pxr/usd/sdf/changeBlock.h>
#include <pxr/usd/sdf/copyUtils.h>
#include <pxr/usd/sdf/layer.h>
#include <pxr/usd/usd/attribute.h>
#include <pxr/usd/usd/prim.h>
#include <pxr/usd/usd/relationship.h>
#include <pxr/usd/usdGeom/imageable.h>
#include <random>
#include <string>
#include <vector>

#include "tests/hydra/host.h"

using namespace msbvh::testing;
PXR_NAMESPACE_USING_DIRECTIVE

namespace {

constexpr std::uint32_t kSize = 32;

constexpr const char* kStage = R"(#usda 1.0
(
    timeCodesPerSecond = 24
    upAxis = "Y"
)
def Camera "cam"
{
    token projection = "perspective"
    float focalLength = 30
    float horizontalAperture = 24
    float verticalAperture = 24
    float2 clippingRange = (0.1, 100)
    double shutter:open = -0.25
    double shutter:close = 0.25
    double3 xformOp:translate = (0, 0, 12)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Scope "Lights"
{
    def DistantLight "sun"
    {
        float inputs:intensity = 2
    }
    def SphereLight "lamp"
    {
        float inputs:intensity = 20
        float inputs:radius = 0.5
        double3 xformOp:translate = (3, 4, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
def Material "red"
{
    token outputs:surface.connect = </red/shader.outputs:surface>
    def Shader "shader"
    {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (0.8, 0.1, 0.1)
        token outputs:surface
    }
}
def Xform "World"
{
    def Xform "a"
    {
        def Mesh "quad" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            uniform token subdivisionScheme = "none"
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        }
    }
    def Xform "b"
    {
        def Sphere "ball" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            double radius = 0.7
        }
        def Mesh "cage" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
            int[] faceVertexIndices = [0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4]
            point3f[] points = [(-1, -1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, 1), (-1, 1, -1), (1, 1, -1), (-1, -1, -1), (1, -1, -1)]
        }
    }
    def PointInstancer "crowd"
    {
        point3f[] positions = [(-3, 2, 0), (3, 2, 0), (0, 3, 0)]
        int[] protoIndices = [0, 0, 0]
        rel prototypes = [</World/crowd/proto>]
        def Mesh "proto"
        {
            uniform token subdivisionScheme = "none"
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(-0.4, 0, 0), (0.4, 0, 0), (0, 0.7, 0)]
        }
    }
    def Points "dots"
    {
        point3f[] points = [(-2, -2, 0), (2, -2, 0)]
        float[] widths = [0.6, 0.4]
    }
    def BasisCurves "hair"
    {
        uniform token type = "linear"
        int[] curveVertexCounts = [3]
        point3f[] points = [(-3, -3, 0), (0, -2.5, 0), (3, -3, 0)]
        float[] widths = [0.2] (interpolation = "constant")
    }
}
)";

UsdStageRefPtr stage_of(const SdfLayerRefPtr& layer) { return UsdStage::Open(layer); }

// The draws of one run, which follow from its seed.
class Editor {
 public:
  Editor(UsdStageRefPtr stage, unsigned seed) : stage_(std::move(stage)), random_(seed) {}

  void edit() {
    const std::vector<std::function<void()>> kinds{
        [&] { move(); },      [&] { deform(); },   [&] { retopologize(); }, [&] { hide(); },
        [&] { bind(); },      [&] { recolor(); },  [&] { light(); },        [&] { camera(); },
        [&] { instances(); }, [&] { remove(); },   [&] { bring_back(); },   [&] { purpose(); },
        [&] { shutter(); },   [&] { reparent(); }, [&] { resize(); }};
    kinds[below(kinds.size())]();
  }

 private:
  std::size_t below(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  float some(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  GfVec3f somewhere(float reach) { return {some(-reach, reach), some(-reach, reach), some(-reach, reach)}; }
  UsdPrim prim(const char* path) const { return stage_->GetPrimAtPath(SdfPath(path)); }
  UsdPrim any(const std::vector<const char*>& paths) { return prim(paths[below(paths.size())]); }

  template <typename T>
  void set(const UsdPrim& prim, const char* name, const SdfValueTypeName& type, const T& value) {
    if (prim) prim.CreateAttribute(TfToken(name), type).Set(value);
  }

  // With two samples as often as with one value.
  void move() {
    const UsdPrim moved = any({"/World", "/World/a", "/World/b", "/World/crowd", "/Lights/lamp", "/cam"});
    if (!moved) return;
    const bool is_camera = moved.GetName() == "cam";
    const GfVec3d centre(0, 0, is_camera ? 12 : 0);
    const TfToken name("xformOp:translate");
    UsdAttribute op = moved.CreateAttribute(name, SdfValueTypeNames->Double3);
    moved
        .CreateAttribute(TfToken("xformOpOrder"), SdfValueTypeNames->TokenArray, false, SdfVariabilityUniform)
        .Set(VtTokenArray{name});
    op.Clear();
    op.Set(centre + GfVec3d(somewhere(1.5f)), UsdTimeCode(0.0));
    if (below(2)) op.Set(centre + GfVec3d(somewhere(1.5f)), UsdTimeCode(1.0));
  }

  void deform() {
    const UsdPrim mesh =
        any({"/World/a/quad", "/World/b/cage", "/World/dots", "/World/hair", "/World/crowd/proto"});
    VtVec3fArray points;
    if (!mesh || !mesh.GetAttribute(TfToken("points")).Get(&points)) return;
    for (GfVec3f& point : points) point += somewhere(0.3f);
    set(mesh, "points", SdfValueTypeNames->Point3fArray, points);
  }

  void retopologize() {
    const bool two = below(2) != 0;
    const UsdPrim mesh = prim("/World/a/quad");
    const SdfChangeBlock all;
    set(mesh, "faceVertexCounts", SdfValueTypeNames->IntArray, two ? VtIntArray{3, 3} : VtIntArray{4});
    set(mesh, "faceVertexIndices", SdfValueTypeNames->IntArray,
        two ? VtIntArray{0, 1, 2, 0, 2, 3} : VtIntArray{0, 1, 2, 3});
  }

  void hide() {
    const UsdPrim hidden = any({"/World/a", "/World/b", "/World/crowd", "/World/dots", "/Lights/sun"});
    set(hidden, "visibility", SdfValueTypeNames->Token, TfToken(below(2) ? "invisible" : "inherited"));
  }

  void bind() {
    const UsdPrim bound = any({"/World/a/quad", "/World/b/cage", "/World/b/ball"});
    if (!bound) return;
    bound.CreateRelationship(TfToken("material:binding"))
        .SetTargets(below(2) ? SdfPathVector{SdfPath("/red")} : SdfPathVector{});
  }

  void recolor() {
    const GfVec3f color(some(0, 1), some(0, 1), some(0, 1));
    if (below(2))
      set(prim("/red/shader"), "inputs:diffuseColor", SdfValueTypeNames->Color3f, color);
    else
      set(any({"/World/a/quad", "/World/b/ball"}), "primvars:displayColor", SdfValueTypeNames->Color3fArray,
          VtVec3fArray{color});
  }

  void light() {
    set(any({"/Lights/sun", "/Lights/lamp"}), "inputs:intensity", SdfValueTypeNames->Float, some(0, 30));
  }

  void camera() { set(prim("/cam"), "focalLength", SdfValueTypeNames->Float, some(20, 50)); }

  void instances() {
    const std::size_t count = below(6);
    VtVec3fArray positions(count);
    for (GfVec3f& position : positions) position = somewhere(3.0f);
    const SdfChangeBlock all;
    set(prim("/World/crowd"), "positions", SdfValueTypeNames->Point3fArray, positions);
    set(prim("/World/crowd"), "protoIndices", SdfValueTypeNames->IntArray, VtIntArray(count, 0));
  }

  void remove() {
    const UsdPrim gone = any({"/World/a/quad", "/World/b/ball", "/World/dots", "/World/hair", "/Lights/sun"});
    if (gone) gone.SetActive(false);
  }

  void bring_back() {
    for (const char* path : {"/World/a/quad", "/World/b/ball", "/World/dots", "/World/hair", "/Lights/sun"}) {
      if (below(2) && prim(path)) prim(path).SetActive(true);
    }
  }

  void purpose() {
    set(any({"/World/a", "/World/dots"}), "purpose", SdfValueTypeNames->Token,
        TfToken(below(2) ? "guide" : "default"));
  }

  void shutter() {
    set(prim("/cam"), "shutter:close", SdfValueTypeNames->Double,
        below(3) ? double(some(0.0f, 0.75f)) : -0.25);
  }

  // The cage goes from one parent to the other.
  void reparent() {
    const SdfLayerHandle layer = stage_->GetRootLayer();
    const SdfPath here("/World/b/cage"), there("/World/a/cage");
    const bool is_here = bool(layer->GetPrimAtPath(here));
    if (!is_here && !layer->GetPrimAtPath(there)) return;
    const SdfPath &from = is_here ? here : there, &to = is_here ? there : here;
    const SdfChangeBlock all;
    SdfCopySpec(layer, from, layer, to);
    SdfBatchNamespaceEdit edits;
    edits.Add(SdfNamespaceEdit::Remove(from));
    layer->Apply(edits);
  }

  void resize() { set(prim("/World/b/ball"), "radius", SdfValueTypeNames->Double, double(some(0.2f, 1.2f))); }

  UsdStageRefPtr stage_;
  std::mt19937 random_;
};

double mean_difference(const Picture& a, const Picture& b, std::size_t channel) {
  double sum = 0.0;
  for (std::size_t i = channel; i < a.rgba.size(); i += 4) sum += double(std::abs(a.rgba[i] - b.rgba[i]));
  return sum / (double(a.width) * a.height);
}

bool covered(const Picture& picture) {
  return std::any_of(picture.prim_ids.begin(), picture.prim_ids.end(), [](int id) { return id >= 0; });
}

std::size_t wanted_edits() {
  const char* wanted = std::getenv("MSBVH_EDITS");
  return wanted ? std::size_t(std::atoll(wanted)) : 400;
}

}  // namespace

TEST_CASE("random edits while it renders end in the picture of a fresh render") {
  const std::size_t edits = wanted_edits();
  for (const Engine engine : {Engine::kSceneDelegate, Engine::kSceneIndices}) {
    CAPTURE(int(engine));
    const SdfLayerRefPtr layer = SdfLayer::CreateAnonymous(".usda");
    REQUIRE(layer->ImportFromString(kStage));
    const UsdStageRefPtr stage = stage_of(layer);
    Host host(stage, engine, SdfPath("/cam"), kSize, kSize);
    host.set("convergedSamplesPerPixel", VtValue(16));
    host.set_time(0.0);
    Editor editor(stage, 7);
    std::mt19937 random(11);
    std::size_t compared = 0, shown = 0;
    for (std::size_t i = 1; i <= edits; ++i) {
      editor.edit();
      if (random() % 3 == 0) host.execute();
      if (i % 50 != 0 && i != edits) continue;
      host.converge();
      const Picture kept = host.picture();
      Host fresh(stage, engine, SdfPath("/cam"), kSize, kSize);
      fresh.set("convergedSamplesPerPixel", VtValue(16));
      fresh.set_time(0.0);
      fresh.converge();
      const Picture alone = fresh.picture();
      // Places are rounded otherwise where the world has kept its origin: a sample on an edge may fall either
      // way.
      const double alpha = mean_difference(kept, alone, 3), red = mean_difference(kept, alone, 0);
      CAPTURE(i);
      CHECK(alpha < 2e-3);
      CHECK(red < 1e-2);
      ++compared;
      shown += covered(alone);
    }
    CHECK(2 * shown > compared);
    MESSAGE("edits: ", edits, " by engine ", int(engine), ", ", compared, " pictures compared, ", shown,
            " of something");
  }
}
