// Render settings: what products inherit, which pixels a data window holds, which AOV a render var names.
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/render/data_window.h"
#include "delegate/translate/render/own_settings.h"
#include "delegate/translate/render/render_spec.h"
#include "delegate/translate/render/render_vars.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

RenderSettingsInput settings_with_product() {
  RenderSettingsInput input;
  input.base.path = "/Render/Settings";
  input.products.emplace_back().base.path = "/Render/Product";
  return input;
}

// Exactly one warning, of that attribute, that says these things.
void check_warned(const std::vector<Diagnostic>& said, const std::string& path, const std::string& attribute,
                  const std::string& text) {
  REQUIRE(said.size() == 1);
  CHECK(said[0].severity == Severity::kWarning);
  CHECK(said[0].path == path);
  CHECK(said[0].attribute == attribute);
  INFO(said[0].message);
  CHECK(said[0].message.find(text) != std::string::npos);
}

std::vector<RenderVarSpec> vars_of(std::vector<RenderVarInput> inputs, std::vector<Diagnostic>& said) {
  return render_vars(inputs, said);
}

struct LeftOutVar {
  RenderVarInput input;
  std::string attribute, text;
};

RenderVarInput var(const std::string& path, const std::string& source, const std::string& type = "raw") {
  return {path, std::nullopt, source, type};
}

}  // namespace

TEST_CASE("a data window holds the pixels whose centres lie within, left and bottom edges included") {
  using Ndc = std::array<float, 4>;
  CHECK(pixel_window(Ndc{0, 0, 1, 1}, 160, 120) == PixelWindow{0, 0, 160, 120});
  CHECK(pixel_window(Ndc{0.4f, 0.1f, 0.6f, 1.2f}, 160, 120) == PixelWindow{64, -24, 32, 132});
  CHECK(pixel_window(Ndc{-0.5f, -0.25f, 1.5f, 1.25f}, 10, 8) == PixelWindow{-5, -2, 20, 12});
  // A centre on the left edge (0.05 of 10 pixels) counts, one on the right edge does not.
  CHECK(pixel_window(Ndc{0.05f, 0, 0.15f, 1}, 10, 1) == PixelWindow{0, 0, 1, 1});
  // The same upwards: y counts from the bottom in NDC and from the top in pixels.
  CHECK(pixel_window(Ndc{0, 0.05f, 1, 0.15f}, 1, 10) == PixelWindow{0, 9, 1, 1});
  CHECK(pixel_window(Ndc{0, 0, 1, 0.5f}, 4, 6) == PixelWindow{0, 3, 4, 3});
}

TEST_CASE("data windows side by side neither overlap nor leave a gap") {
  for (const std::int64_t pixels : {1, 2, 3, 7, 10, 97, 1920}) {
    for (const int parts : {2, 3, 5, 8, 16}) {
      std::int64_t next = 0;
      for (int part = 0; part < parts; ++part) {
        const float low = float(part) / float(parts), high = float(part + 1) / float(parts);
        const auto found = pixel_window({low, 0, high, 1}, pixels, 1);
        if (!found) continue;
        CHECK(found->x == next);
        next = found->x + found->width;
      }
      CHECK(next == pixels);
    }
  }
}

TEST_CASE("a data window without a pixel's centre, or with absurdly many, holds none") {
  CHECK(!pixel_window({0.1f, 0, 0.12f, 1}, 10, 10));
  CHECK(!pixel_window({0, 0, 1e6f, 1}, 100, 100));
  CHECK(!pixel_window({1e30f, 0, 2e30f, 1}, 100, 100));
  RenderSettingsInput input = settings_with_product();
  input.base.data_window_ndc = {0.1f, 0.0f, 0.12f, 1.0f};
  std::vector<Diagnostic> said;
  const RenderSpec spec = render_spec(input, said);
  CHECK(said.empty());
  CHECK(pixels_of(spec.products[0].data_window_ndc, spec.products[0].path, 10, 20, said) ==
        PixelWindow{0, 0, 10, 20});
  check_warned(said, "/Render/Product", "dataWindowNDC", "at 10 x 20");
}

TEST_CASE("the part of the camera's window is that of the pixels, not of the window as authored") {
  const WindowPart part = window_part({64, -24, 32, 132}, 160, 120);
  CHECK(part.left == doctest::Approx(0.4));
  CHECK(part.right == doctest::Approx(0.6));
  CHECK(part.bottom == doctest::Approx(0.1));
  CHECK(part.top == doctest::Approx(1.2));
}

TEST_CASE("a product inherits from the settings what it does not author") {
  RenderSettingsInput input = settings_with_product();
  input.base.camera = "/cam";
  input.base.resolution = {320, 200};
  input.base.pixel_aspect_ratio = 2.0;
  input.base.aspect_ratio_conform_policy = "cropAperture";
  input.base.data_window_ndc = {0.0f, 0.0f, 0.5f, 1.0f};
  input.base.disable_motion_blur = true;
  input.products.emplace_back().base.path = "/Render/Other";
  RenderBaseInput& other = input.products[1].base;
  other.camera = "/other";
  other.resolution = {64, 48};
  other.disable_motion_blur = false;
  other.disable_depth_of_field = true;
  std::vector<Diagnostic> said;
  const RenderSpec spec = render_spec(input, said);
  CHECK(said.empty());
  REQUIRE(spec.products.size() == 2);
  const ProductSpec &first = spec.products[0], &second = spec.products[1];
  CHECK(first.path == "/Render/Product");
  CHECK(first.camera == "/cam");
  CHECK(first.width == 320);
  CHECK(first.pixel_aspect_ratio == 2.0);
  CHECK(first.policy == AspectPolicy::kCropAperture);
  CHECK(!first.motion_blur);
  CHECK(first.depth_of_field);
  CHECK(second.camera == "/other");
  CHECK(second.height == 48);
  CHECK(second.data_window_ndc == first.data_window_ndc);
  CHECK(second.motion_blur);
  CHECK(!second.depth_of_field);
}

TEST_CASE("fallbacks are the schema's") {
  std::vector<Diagnostic> said;
  const RenderSpec spec = render_spec(settings_with_product(), said);
  CHECK(said.empty());
  CHECK(spec.products[0].width == 2048);
  CHECK(spec.products[0].height == 1080);
  CHECK(!spec.products[0].sets_resolution);
  CHECK(spec.included_purposes == std::vector<std::string>{"default", "render"});
  CHECK(!spec.sets_purposes);
  CHECK(spec.material_purpose == "full");
}

TEST_CASE("the deprecated instantaneousShutter turns motion blur off") {
  RenderSettingsInput input = settings_with_product();
  input.base.instantaneous_shutter = true;
  std::vector<Diagnostic> said;
  CHECK(!render_spec(input, said).products[0].motion_blur);
  input.products[0].base.disable_motion_blur = false;  // the product's own opinion is stronger
  CHECK(render_spec(input, said).products[0].motion_blur);
  input.products[0].base.instantaneous_shutter = false;
  CHECK(render_spec(input, said).products[0].motion_blur);
}

TEST_CASE("a value that makes no sense is ignored with one warning, and the weaker one counts") {
  const auto warned = [](auto change, const std::string& attribute, const std::string& text, auto same) {
    RenderSettingsInput input = settings_with_product();
    input.base.resolution = {320, 200};
    input.base.pixel_aspect_ratio = 2.0;
    input.base.data_window_ndc = {0.0f, 0.0f, 0.5f, 1.0f};
    std::vector<Diagnostic> said;
    const RenderSpec before = render_spec(input, said);
    REQUIRE(said.empty());
    change(input.products[0].base);
    const RenderSpec after = render_spec(input, said);
    check_warned(said, "/Render/Product", attribute, text);
    CHECK(same(before.products[0], after.products[0]));
  };
  const auto size = [](const ProductSpec& a, const ProductSpec& b) {
    return a.width == b.width && a.height == b.height;
  };
  for (const std::array<std::int64_t, 2> bad :
       {std::array<std::int64_t, 2>{0, 100}, {-5, 5}, {100, 65536}, {std::int64_t(1) << 40, 1}})
    warned([&](RenderBaseInput& base) { base.resolution = bad; }, "resolution", "expected 1 to 65535", size);
  const auto aspect = [](const ProductSpec& a, const ProductSpec& b) {
    return a.pixel_aspect_ratio == b.pixel_aspect_ratio;
  };
  for (const double bad : {0.0, -1.0, double(kNan), double(kInf), 1e9})
    warned([&](RenderBaseInput& base) { base.pixel_aspect_ratio = bad; }, "pixelAspectRatio",
           "expected a number", aspect);
  warned([](RenderBaseInput& base) { base.aspect_ratio_conform_policy = "stretch"; },
         "aspectRatioConformPolicy", "found 'stretch', expected one of expandAperture",
         [](const ProductSpec& a, const ProductSpec& b) { return a.policy == b.policy; });
  const auto window = [](const ProductSpec& a, const ProductSpec& b) {
    return a.data_window_ndc == b.data_window_ndc;
  };
  for (const std::array<float, 4> bad :
       {std::array<float, 4>{kNan, 0, 1, 1}, {0, 0, kInf, 1}, {0.5f, 0, 0.5f, 1}, {0, 1, 1, 0}})
    warned([&](RenderBaseInput& base) { base.data_window_ndc = bad; }, "dataWindowNDC", "xmin < xmax",
           window);
}

TEST_CASE("types of products, purposes and colour spaces that are not honoured are named") {
  const auto warned = [](auto change, const std::string& path, const std::string& attribute,
                         const std::string& text) {
    RenderSettingsInput input = settings_with_product();
    change(input);
    std::vector<Diagnostic> said;
    const RenderSpec spec = render_spec(input, said);
    check_warned(said, path, attribute, text);
    return spec;
  };
  const std::string settings = "/Render/Settings", product = "/Render/Product";
  warned([](auto& input) { input.products[0].product_type = "deepRaster"; }, product, "productType",
         "as raster");
  warned([](auto& input) { input.products[0].product_type = "arnold"; }, product, "productType",
         "found 'arnold'");
  RenderSpec spec = warned(
      [](auto& input) {
        input.included_purposes = {{"default", "proxy", "hidden"}};
      },
      settings, "includedPurposes", "found 'hidden'");
  CHECK(spec.included_purposes == std::vector<std::string>{"default", "proxy"});
  warned([](auto& input) { input.included_purposes = {{"render"}}; }, settings, "includedPurposes",
         "no default");
  spec = warned(
      [](auto& input) {
        input.material_binding_purposes = {{"preview", "full", ""}};
      },
      settings, "materialBindingPurposes", "took 'preview'");
  CHECK(spec.material_purpose == "preview");
  warned(
      [](auto& input) {
        input.material_binding_purposes = {{"glossy", "full", ""}};
      },
      settings, "materialBindingPurposes", "found 'glossy'");
  warned([](auto& input) { input.material_binding_purposes = {{"full"}}; }, settings,
         "materialBindingPurposes", "all the same");
  warned([](auto& input) { input.rendering_color_space = "lin_p3d65"; }, settings, "renderingColorSpace",
         "ignored");
  warned(
      [](auto& input) {
        input.products[0].base.settings = {{"msbvh:seed", std::int64_t(1)}};
      },
      product, "msbvh:seed", "on the render settings");
  // What exporters write, and what is meant.
  RenderSettingsInput input = settings_with_product();
  input.material_binding_purposes = {{"full", "allPurpose"}};
  input.rendering_color_space = "lin_rec709_scene";
  std::vector<Diagnostic> said;
  CHECK(render_spec(input, said).material_purpose == "full");
  CHECK(said.empty());
}

TEST_CASE("render vars name colour or an AOV by several names") {
  std::vector<Diagnostic> said;
  const auto aov_of = [&](const std::string& source, const std::string& type) {
    const std::vector<RenderVarSpec> found = vars_of({var("/Vars/x", source, type)}, said);
    REQUIRE(found.size() == 1);
    CHECK(found[0].name == "x");
    return found[0].aov;
  };
  for (const char* name : {"color", "Ci", "C", "RGBA", "beauty"}) CHECK(!aov_of(name, "raw"));
  for (const char* expression :
       {"C.*[LO]", "C.*[<L.>O]", "color lpe:C.*[<L.>O]", "lpe:C.*[LO]", "C[DS]*[LO]"})
    CHECK(!aov_of(expression, "lpe"));
  CHECK(aov_of("depth", "raw") == Aov::kDepth);
  CHECK(aov_of("z", "intrinsic") == Aov::kCameraDepth);
  CHECK(aov_of("cameraDepth", "raw") == Aov::kCameraDepth);
  CHECK(aov_of("N", "raw") == Aov::kNormal);
  for (std::size_t i = 0; i < kAovCount; ++i) CHECK(aov_of(form_of(Aov(i)).name, "raw") == Aov(i));
  CHECK(said.empty());
  // The schema's empty sourceName: the prim's name.
  const std::vector<RenderVarSpec> found = vars_of({{"/Vars/normal", {}, {}, {}}}, said);
  REQUIRE(found.size() == 1);
  CHECK(found[0].aov == Aov::kNormal);
  CHECK(channel_names(found[0]) == std::vector<std::string>{"normal.X", "normal.Y", "normal.Z"});
}

TEST_CASE("render vars that cannot be written are left out with a warning") {
  for (const LeftOutVar& each :
       {LeftOutVar{var("/V/a", "motionvector"), "sourceName", "found 'motionvector', expected color"},
        LeftOutVar{var("/V/a", "C<RD>[LO]", "lpe"), "sourceName", "expected C.*[LO]"},
        LeftOutVar{var("/V/a", "st", "primvar"), "sourceType", "not written yet"},
        LeftOutVar{var("/V/a", "color", "shader"), "sourceType", "found 'shader'"}}) {
    std::vector<Diagnostic> said;
    CHECK(vars_of({each.input}, said).empty());
    check_warned(said, "/V/a", each.attribute, each.text);
    CHECK(said[0].message.find("left out") != std::string::npos);
  }
}

TEST_CASE("of render vars that would write the same channel the first counts") {
  for (const auto& [first, second] : {std::pair{var("/A/x", "depth"), var("/B/x", "cameraDepth")},
                                      {var("/A/x", "color"), var("/B/y", "Ci")},
                                      {var("/A/x", "color"), var("/B/A", "depth")},
                                      {var("/A/x", "normal"), var("/B/x", "Neye")}}) {
    std::vector<Diagnostic> said;
    const std::vector<RenderVarSpec> found = vars_of({first, second}, said);
    REQUIRE(found.size() == 1);
    CHECK(found[0].path == first.path);
    check_warned(said, second.path, "", "twice in the product");
  }
  std::vector<Diagnostic> said;
  CHECK(vars_of({var("/A/x", "depth"), var("/A/y", "depth")}, said).size() == 2);
  CHECK(said.empty());
}

TEST_CASE("an authored dataType says the format of the channels") {
  std::vector<Diagnostic> said;
  const auto format = [&](const std::string& source, const char* type) {
    RenderVarInput input = var("/V/a", source);
    if (type) input.data_type = type;
    const std::vector<RenderVarSpec> found = vars_of({input}, said);
    REQUIRE(found.size() == 1);
    return found[0].format;
  };
  CHECK(!format("color", nullptr));
  CHECK(format("color", "color4h") == ChannelFormat::kHalf);
  CHECK(format("color", "color3f") == ChannelFormat::kFloat);
  CHECK(format("normal", "normal3h") == ChannelFormat::kHalf);
  CHECK(format("depth", "half") == ChannelFormat::kHalf);
  CHECK(format("primId", "int") == ChannelFormat::kFloat);
  CHECK(said.empty());
  CHECK(!format("color", "string"));
  check_warned(said, "/V/a", "dataType", "found 'string'");
  said.clear();
  CHECK(format("depth", "color3f") == ChannelFormat::kFloat);
  check_warned(said, "/V/a", "dataType", "expected 1 numbers a pixel");
  said.clear();
  CHECK(format("primId", "half") == ChannelFormat::kFloat);
  check_warned(said, "/V/a", "dataType", "written as float");
}

TEST_CASE("a picture's window and its pixels' aspect ratio are UsdRenderComputeSpec's") {
  const Window square{-1, 1, -1, 1};
  // 200 x 100 pixels, each twice as high as wide: a square.
  const Conformed tall = conformed_picture(square, 200, 100, 0.5, AspectPolicy::kExpandAperture);
  CHECK(tall.pixel_aspect_ratio == 0.5);
  CHECK(tall.window.width() == 2.0);
  CHECK(tall.window.height() == 2.0);
  const Conformed wide = conformed_picture(square, 200, 100, 1.0, AspectPolicy::kExpandAperture);
  CHECK(wide.window.width() == 4.0);
  // Disregards the one that is authored.
  const Conformed fitted = conformed_picture(square, 200, 100, 3.0, AspectPolicy::kAdjustPixelAspectRatio);
  CHECK(fitted.window.width() == 2.0);
  CHECK(fitted.pixel_aspect_ratio == 0.5);
}

TEST_CASE("our own settings are read by name, type and range") {
  std::vector<Diagnostic> said;
  const OwnSettings own = own_settings({{"msbvh:samplesPerPixel", std::int64_t(16)},
                                        {"msbvh:seed", std::int64_t(4294967295)},
                                        {"msbvh:motionTolerance", 0.5},
                                        {"msbvh:noise", 0.05},
                                        {"msbvh:edgeLength", std::int64_t(2)},
                                        {"msbvh:segments", std::int64_t(8)},
                                        {"msbvh:refraction", true},
                                        {"msbvh:builder", std::string("mbvh")},
                                        {"arnold:AA_samples", std::int64_t(-1)}},
                                       "/S", said);
  CHECK(said.empty());
  CHECK(own.samples == 16);
  CHECK(own.seed == 4294967295);
  CHECK(own.motion_tolerance == 0.5);
  CHECK(own.noise == 0.05);
  CHECK(own.edge_length == 2.0);
  CHECK(own.segments == 8);
  CHECK(own.refraction == true);
  CHECK(own.builder == "mbvh");
  CHECK(!own.layout);
  for (const auto& [setting, text] :
       {std::pair{NamedSetting{"msbvh:samplesPerPixel", std::int64_t(0)}, "from 1 to"},
        {NamedSetting{"msbvh:samplesPerPixel", 16.0}, "found 16, expected an integer"},
        {NamedSetting{"msbvh:seed", {}, "int[]"}, "found int[]"},
        {NamedSetting{"msbvh:seed", true}, "found true"},
        {NamedSetting{"msbvh:refraction", std::int64_t(1)}, "found 1, expected a bool"},
        {NamedSetting{"msbvh:motionTolerance", std::nan("")}, "a finite number"},
        {NamedSetting{"msbvh:noise", -0.5}, "found -0.5, expected a number from 0 to 1"},
        {NamedSetting{"msbvh:noise", std::nan("")}, "from 0 to 1"},
        {NamedSetting{"msbvh:segments", std::int64_t(12)}, "a power of two"},
        {NamedSetting{"msbvh:builder", std::string("bvh8")}, "found 'bvh8', expected one of msbvh"},
        {NamedSetting{"msbvh:sampels", std::int64_t(1)}, "unknown"}}) {
    said.clear();
    const OwnSettings none = own_settings({setting}, "/S", said);
    CHECK(!none.samples);
    CHECK(!none.seed);
    check_warned(said, "/S", setting.name, text);
  }
}
