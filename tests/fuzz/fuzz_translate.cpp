// The translator: what is wrong leaves an error that names it and the attribute, and is left out; nothing
// throws but a camera that cannot be used. The scene that comes of the rest passes the core's gate, whatever
// was read, and is drawn without a pixel that is not a number.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "core/api/renderer.h"
#include "delegate/translate/translator.h"
#include "tests/fuzz/fuzzed_inputs.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;
using namespace msbvh::translate;

namespace {

// That are built and verified: surfaces near the camera are cut to millions.
constexpr std::size_t kMostTriangles = 20'000;

// Refinement, displacement and sampling stay small, so that many inputs are tried: surfaces reach up to the
// camera's near plane, where edges are millions of pixels long.
TranslatorSettings fuzzed_settings(FuzzedData& data) {
  TranslatorSettings settings;
  settings.width = settings.height = data.one_of({32u, 1u, 64u});
  settings.motion_tolerance_pixels = data.one_of({0.1, 1.0, 1e-3});
  settings.max_segments = data.one_of({kMaxSegments, 1u, 8u});
  settings.choice.min_degree = data.one_of({1u, 1u, 2u, 3u});
  settings.choice.max_degree = std::max(settings.choice.min_degree, data.one_of({3u, 1u, 2u}));
  settings.choice.segments = data.one_of({0u, 0u, 0u, 4u});
  settings.keep_faces = data.coin();
  settings.measure_shape = data.rarely();
  settings.edge_length_pixels = data.one_of({1e4, 0.0, 1e6, 1e5});
  settings.curves = data.coin() ? CurveStyle::kRibbon : CurveStyle::kTube;
  settings.displaced =
      data.one_of({Displaced::kByMemory, Displaced::kNot, Displaced::kAsTriangles, Displaced::kAsPatches});
  return settings;
}

void check_said(const Translator& translator) {
  for (const Diagnostic& d : translator.diagnostics()) {
    if (d.path.empty() || d.message.empty() || d.message.find('\n') != std::string::npos) {
      fail("a message that names no prim, or is not one line: " + d.path + ": " + d.attribute + ": " +
           d.message);
    }
  }
  for (const TrackReport& track : translator.tracks()) {
    require(is_valid_form({track.segments, track.degree}), "a track that there is not");
    require(!(track.error_pixels < 0.0), "an error below 0");
  }
}

void add_all(Translator& translator, FuzzedData& data, Arrays& arrays) {
  const std::uint32_t materials = data.below(3);
  for (std::uint32_t i = 0; i < materials; ++i) {
    std::optional<Displacement> displacement;
    if (data.rarely()) {
      displacement.emplace();
      displacement->origin = {"/material", "inputs:displacement"};
      displacement->constant = std::clamp(data.real(), -kMaxDistance, kMaxDistance);
      if (std::isnan(displacement->constant)) displacement->constant = 0.0;
      if (data.coin()) displacement->primvar = "height";
    }
    translator.add_material(fuzzed_look(data), displacement);
  }
  for (std::uint32_t n = data.below(3); n > 0; --n)
    translator.add_mesh(fuzzed_mesh_input(data, arrays, materials));
  if (data.coin()) {
    const std::uint32_t prototype =
        translator.begin_prototype("/prototype", data.rarely() ? data.positive() : 0.0);
    translator.add_prototype_mesh(prototype, fuzzed_mesh_input(data, arrays, materials));
    translator.add_instances(fuzzed_instances(data, arrays, prototype, materials));
  }
  for (std::uint32_t n = data.below(3); n > 0; --n) translator.add_light(fuzzed_light_input(data));
}

std::size_t triangles_of(const Scene& scene) {
  std::size_t sum = 0;
  for (const Mesh& mesh : scene.meshes) sum += mesh.shape.triangles.size() * mesh.shape.form().controls();
  for (const Grids& grids : scene.grids)
    sum += std::size_t(grids.shape.triangle_count()) * grids.shape.form().controls();
  for (const Curves& curves : scene.curves) sum += curves.shape.spans.size() * curves.shape.form().controls();
  return sum;
}

void draw(const std::shared_ptr<const Scene>& scene, FuzzedData& data) {
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.spp = 1;
  settings.max_bounces = data.below(3);
  settings.threads = 1;
  settings.build.layout = data.one_of({TreeLayout::kFull, TreeLayout::kCompact});
  Renderer renderer;
  renderer.commit(scene, settings);
  renderer.verify();
  const Image image = renderer.render();
  for (const float value : image.rgba) require(!std::isnan(value), "a pixel that is not a number");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  const TranslatorSettings settings = fuzzed_settings(data);
  const CameraInput camera = fuzzed_camera_input(data);
  Arrays arrays;
  std::optional<Translator> translator;
  if (!passes([&] { translator.emplace(camera, settings); })) return 0;
  add_all(*translator, data, arrays);
  check_said(*translator);
  const std::shared_ptr<const Scene> scene = translator->finish();
  // The translator answers for what it makes; but a camera that is singular at a key, between samples that
  // are not, is the core's to refuse.
  try {
    validate(*scene);
  } catch (const Error& error) {
    if (!std::string(error.what()).starts_with("/camera: ")) throw;
    return 0;
  }
  if (triangles_of(*scene) <= kMostTriangles) draw(scene, data);
  return 0;
}
