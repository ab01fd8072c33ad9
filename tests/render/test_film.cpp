// Pictures through filters and shutters, against closed forms.
#include <array>
#include <bit>

#include "core/film/film_settings.h"
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSpp = 4096;

RenderSettings settings_of(std::uint32_t width, std::uint32_t height, const FilmSettings& film) {
  return {.width = width, .height = height, .spp = kSpp, .max_bounces = 0, .film = film, .build = {}};
}

// The share of a filter of that width right of `x` pixels from its centre.
double share_right_of(const PixelFilter& filter, double x) {
  constexpr int kSteps = 20000;
  double right = 0.0, all = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = 2.0 * (i + 0.5) / kSteps - 1.0, weight = filter_weight(filter.shape, r);
    all += weight;
    if (0.5 * r * filter.width > x) right += weight;
  }
  return right / all;
}

TEST_CASE("an edge is as soft as the filter makes it, also at the picture's sides") {
  Scene scene;
  scene.camera = pixel_camera(4, 1);
  add(scene, polygon({rectangle(1.25f, -9, 3.75f, 9)}));
  for (const FilterName& name : kFilters) {
    for (const float width : {name.width, 2.5f}) {
      CAPTURE(name.name);
      CAPTURE(width);
      const PixelFilter filter{name.shape, width};
      const Image image = render(scene, settings_of(4, 1, {.filter = filter}));
      for (std::uint32_t x = 0; x < 4; ++x) {
        const double centre = x + 0.5;
        const double expected = share_right_of(filter, 1.25 - centre) - share_right_of(filter, 3.75 - centre);
        CHECK(channel(image, x, 0, kAlpha) == doctest::Approx(expected).scale(1.0).epsilon(2e-3));
      }
    }
  }
}

// From [-1, 1] to [1, 3].
Scene hopping_quad() {
  Scene scene;
  scene.camera = pixel_camera(2, 1);
  add(scene, polygon({rectangle(-1, -9, 1, 9), rectangle(1, -9, 3, 9)}));
  return scene;
}

TEST_CASE("a moving edge is as soft as the shutter makes it") {
  // Its right edge lies at 1 + 2 t: pixel 1 is covered by min(1, 2 t), in the mean over the curve.
  for (const ShutterCurve& curve : {box_curve(), triangle_curve(), trapezoid_curve()}) {
    const Image image = render(hopping_quad(), settings_of(2, 1, {.shutter_curve = curve}));
    double expected = 0.0, all = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const double t = (i + 0.5) / 20000;
      const double weight = curve.empty() ? 1.0 : integral(curve, t - 0.5 / 20000, t + 0.5 / 20000);
      expected += weight * std::min(1.0, 2.0 * t);
      all += weight;
    }
    CHECK(channel(image, 1, 0, kAlpha) == doctest::Approx(expected / all).epsilon(2e-3));
  }
}

TEST_CASE("a rolling shutter shears what moves") {
  Scene scene;
  scene.camera = pixel_camera(8, 8);
  add(scene, polygon({rectangle(-8, -9, 0, 17), rectangle(0, -9, 8, 17)}));  // its right edge is at 8 t
  FilmSettings film;
  film.rolling.share = 1.0f;
  const Image image = render(scene, settings_of(8, 8, film));
  for (std::uint32_t y = 0; y < 8; ++y) {
    CAPTURE(y);
    float covered = 0.0f;
    for (std::uint32_t x = 0; x < 8; ++x) covered += channel(image, x, y, kAlpha);
    CHECK(covered == doctest::Approx(y + 0.5).epsilon(1e-3));  // seen at t = (y + 0.5) / 8
  }
}

TEST_CASE("slices of the shutter sum up to the picture, and hold what is seen in each") {
  const Scene scene = hopping_quad();
  RenderSettings settings = settings_of(2, 1, {});
  settings.spp = 64;
  settings.film.shutter_slices = 4;
  const Image image = render(scene, settings);
  REQUIRE(image.slices.size() == 4 * 2 * 4);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    double sum = 0.0;
    for (std::size_t slice = 0; slice < 4; ++slice) sum += double(image.slices[8 * slice + i]);
    CHECK(sum == doctest::Approx(image.rgba[i]).epsilon(1e-6));
  }
  // Pixel 1 is whole from the middle of the shutter on; a slice is a quarter of the samples.
  CHECK(image.slices[8 * 2 + 4 + 3] == 0.25f);
  CHECK(image.slices[8 * 3 + 4 + 3] == 0.25f);
  CHECK(image.slices[8 * 0 + 4 + 3] == doctest::Approx(0.25 * 0.25).epsilon(0.05));
  for (const std::uint32_t batch : {1u, 6u, 100u}) {
    settings.batch_paths = batch;
    settings.threads = 1 + batch % 3;
    const Image again = render(scene, settings);
    CHECK(again.slices == image.slices);
    CHECK(again.rgba == image.rgba);
  }
  settings.film.shutter_slices = 0;
  CHECK(render(scene, settings).rgba == image.rgba);
}

TEST_CASE("a Cryptomatte's coverage sums up to alpha, by the prims that are seen") {
  Scene scene = hopping_quad();
  Mesh other = polygon({rectangle(0, 0, 1, 0.25f, 5.0f)});
  other.shape.name = "/other";
  add(scene, other);
  for (const PixelFilter& filter : {PixelFilter{}, PixelFilter{FilterShape::kGaussian, 2.0f}}) {
    RenderSettings settings = settings_of(2, 1, {.filter = filter});
    settings.aovs = {Aov::kCryptoObject};
    Renderer renderer;
    renderer.commit(std::make_shared<Scene>(scene), settings);
    const Image image = renderer.render();
    const std::vector<float>& values = image.aovs[0].values;
    for (std::size_t pixel = 0; pixel < 2; ++pixel) {
      double sum = 0.0;
      for (std::size_t rank = 0; rank < kCryptoRanks; ++rank)
        sum += double(values[12 * pixel + 2 * rank + 1]);
      CHECK(sum == doctest::Approx(image.rgba[4 * pixel + 3]).epsilon(1e-6));
    }
    const auto id = std::bit_cast<std::uint32_t>(values[2]);  // the second of pixel 0
    const auto names = renderer.crypto_manifest(Aov::kCryptoObject, std::array{id});
    REQUIRE(names.size() == 1);
    CHECK(names[0].second == id);
    CHECK((names[0].first == "/other" || names[0].first == "/polygon"));
  }
}

TEST_CASE("what is not asked for changes no bit, and parts of the samples add up") {
  const Scene scene = hopping_quad();
  RenderSettings plain = settings_of(2, 1, {}), asked = plain;
  asked.film = {.filter = {FilterShape::kBox, 1.0f}, .shutter_curve = {}, .rolling = {}};
  CHECK(render(scene, plain).rgba == render(scene, asked).rgba);
  asked.film = {.filter = {FilterShape::kGaussian, 2.0f}, .shutter_curve = triangle_curve()};
  asked.spp = 64;
  const std::vector<float> whole = render(scene, asked).rgba;
  Renderer renderer;
  asked.batch_paths = 7;
  renderer.commit(std::make_shared<Scene>(scene), asked);
  const Image first = renderer.render(SampleRange{0, 32}), second = renderer.render(SampleRange{32, 32});
  for (std::size_t i = 0; i < whole.size(); ++i)
    CHECK(whole[i] == doctest::Approx(0.5 * (double(first.rgba[i]) + second.rgba[i])).epsilon(1e-6));
}

}  // namespace
}  // namespace msbvh
