// What core/texture reads: where texels are, how they are filtered, in which colours. Files that are wrong:
// test_texture_faults.cpp.
#include <atomic>
#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/texture/reduce.h"
#include "core/texture/texture_cache.h"
#include "tests/support/picture_files.h"

using namespace msbvh;

namespace {

ImageTexture texture(const std::string& path, TextureWrap wrap = TextureWrap::kClamp) {
  REQUIRE(!path.empty());
  ImageTexture result;
  result.name = path;
  result.tiles = {{0, 0, {path, 0, 0}}};
  result.wrap_s = result.wrap_t = wrap;
  return result;
}

TexelColor read(const TextureCache& cache, const TextureQuery& query, TextureId id = 0) {
  TexelColor result;
  cache.read(id, std::span(&query, 1), std::span(&result, 1));
  return result;
}

TexelColor read_point(const TextureCache& cache, float s, float t, TextureId id = 0) {
  return read(cache, {s, t, 0, 0, 0, 0}, id);
}

// Of texel x, y from the upper left, in a picture of that size.
TexelColor read_texel(const TextureCache& cache, int x, int y, int width, int height, TextureId id = 0) {
  return read_point(cache, (x + 0.5f) / width, 1.0f - (y + 0.5f) / height, id);
}

float noise(int x, int y, int channel) {
  std::uint32_t bits = static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                       static_cast<std::uint32_t>(channel) * 83492791u;
  for (int i = 0; i < 3; ++i) bits = (bits ^ bits >> 15) * 0x2c1b3c6du;
  return static_cast<float>(bits >> 8) / 16777216.0f;
}

// Weighted evenly over s0 to s1 and t0 to t1, by points far closer than texels.
double slow_mean(const pictures::Texel& texel, int width, int height, double s0, double s1, double t0,
                 double t1) {
  constexpr int kPoints = 512;
  double sum = 0;
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const double s = s0 + (s1 - s0) * (i + 0.5) / kPoints, t = t0 + (t1 - t0) * (j + 0.5) / kPoints;
      sum += texel(static_cast<int>(s * width), static_cast<int>((1 - t) * height), 0);
    }
  }
  return sum / (kPoints * kPoints);
}

double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace

TEST_CASE("texture: (0, 0) is the lower left corner, (1, 0) the lower right one") {
  const pictures::Folder folder;
  const std::string path = folder.write("a.exr", 2, 2, 3, [](int x, int y, int c) {
    return c == 0 ? static_cast<float>(x) : c == 1 ? static_cast<float>(y) : 0.25f;
  });
  const TextureCache cache({texture(path)}, {});
  CHECK(read_point(cache, 0.0f, 0.0f) == TexelColor{0, 1, 0.25f, 1});
  CHECK(read_point(cache, 1.0f, 0.0f) == TexelColor{1, 1, 0.25f, 1});
  CHECK(read_point(cache, 0.0f, 1.0f) == TexelColor{0, 0, 0.25f, 1});
  CHECK(read_point(cache, 1.0f, 1.0f) == TexelColor{1, 0, 0.25f, 1});
  CHECK(cache.faults().empty());
  CHECK(cache.size(0).width == 2);
}

TEST_CASE("texture: a point at a texel's centre is that texel to the bit, in rows and tiles") {
  const pictures::Folder folder;
  constexpr int kWidth = 150, kHeight = 90;  // no multiples of tiles
  for (int tile : {0, 32}) {
    const std::string path = folder.write("a.exr", kWidth, kHeight, 4, noise, {.tile = tile});
    const TextureCache cache({texture(path)}, {});
    int wrong = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const TexelColor found = read_texel(cache, x, y, kWidth, kHeight);
        for (int c = 0; c < 4; ++c) wrong += std::abs(found[c] - noise(x, y, c)) > 2e-5f;
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("texture: between centres values are bilinear") {
  const pictures::Folder folder;
  const std::string path = folder.write("a.exr", 8, 8, 1, [](int x, int y, int) { return x + 10.0f * y; });
  const TextureCache cache({texture(path)}, {});
  for (float s : {0.1f, 0.33f, 0.5f, 0.9f})
    for (float t : {0.2f, 0.51f, 0.8f}) {
      const float expected = (8 * s - 0.5f) + 10.0f * (8 * (1 - t) - 0.5f);
      CHECK(read_point(cache, s, t)[0] == doctest::Approx(expected).epsilon(1e-5));
    }
}

TEST_CASE("texture: wraps by axis") {
  const pictures::Folder folder;
  constexpr int kSide = 4;
  const std::string path = folder.write("a.exr", kSide, kSide, 3, noise);
  const std::string silent = path;
  const std::string says = folder.write("b.tif", kSide, kSide, 3, noise, {.wrap_modes = "periodic,mirror"});
  const auto in = [](int texel, TextureWrap wrap) {  // -1: black
    if (texel >= 0 && texel < kSide) return texel;
    if (wrap == TextureWrap::kClamp) return texel < 0 ? 0 : kSide - 1;
    const int turn = ((texel % kSide) + kSide) % kSide;
    if (wrap == TextureWrap::kRepeat) return turn;
    const bool odd = (static_cast<int>(std::floor(static_cast<double>(texel) / kSide)) & 1) != 0;
    return wrap == TextureWrap::kMirror ? (odd ? kSide - 1 - turn : turn) : -1;
  };
  const auto check = [&](const std::string& file, TextureWrap s, TextureWrap t, TextureWrap real_s,
                         TextureWrap real_t) {
    ImageTexture wrapped = texture(file);
    wrapped.wrap_s = s;
    wrapped.wrap_t = t;
    const TextureCache cache({wrapped}, {});
    int wrong = 0;
    for (int row = -9; row < 13; ++row) {  // from the bottom
      for (int x = -9; x < 13; ++x) {
        const TexelColor found = read_point(cache, (x + 0.5f) / kSide, (row + 0.5f) / kSide);
        const int column = in(x, real_s), line = in(row, real_t);
        for (int c = 0; c < 3; ++c) {
          const float expected = column < 0 || line < 0 ? 0.0f : noise(column, kSide - 1 - line, c);
          wrong += std::abs(found[c] - expected) > 2e-5f;
        }
      }
    }
    CHECK(wrong == 0);
  };
  const std::vector<TextureWrap> all{TextureWrap::kBlack, TextureWrap::kClamp, TextureWrap::kRepeat,
                                     TextureWrap::kMirror};
  for (TextureWrap s : all)
    for (TextureWrap t : all) check(path, s, t, s, t);
  check(silent, TextureWrap::kMetadata, TextureWrap::kRepeat, TextureWrap::kBlack, TextureWrap::kRepeat);
  check(says, TextureWrap::kMetadata, TextureWrap::kMetadata, TextureWrap::kRepeat, TextureWrap::kMirror);
}

TEST_CASE("texture: coordinates of any size and kind give a texel, never NaN") {
  const pictures::Folder folder;
  const std::string path = folder.write("a.exr", 16, 16, 3, [](int, int, int) { return 0.5f; });
  const float far = 1e30f, infinite = HUGE_VALF, none = std::nanf("");
  for (TextureWrap wrap :
       {TextureWrap::kBlack, TextureWrap::kClamp, TextureWrap::kRepeat, TextureWrap::kMirror}) {
    const TextureCache cache({texture(path, wrap)}, {});
    for (float s : {0.5f, -3e5f, far, -far, infinite, none})
      for (float d : {0.0f, 1e-30f, 1.0f, far, infinite, none}) {
        const TexelColor found = read(cache, {s, 0.5f, d, 0, 0, -d});
        for (float value : found) CHECK((value >= 0.0f && value <= 1.0f));
      }
    CHECK(read(cache, {0.25f, 0.5f, 0, 0, 0, 0})[0] == 0.5f);
    CHECK(cache.faults().empty());
  }
}

TEST_CASE("texture: each level is the mean of the finer one, for any size") {
  for (const auto& [width, height] :
       {std::pair(37, 21), std::pair(64, 32), std::pair(5, 1), std::pair(1, 3)}) {
    LevelSize fine{width, height};
    std::vector<float> texels;
    for (int i = 0; i < width * height; ++i) texels.push_back(noise(i, 3, 0));
    double mean = 0;
    for (float value : texels) mean += value / (width * height);
    while (fine.width > 1 || fine.height > 1) {
      const LevelSize coarse = next_coarser(fine);
      std::vector<float> next(static_cast<std::size_t>(coarse.width) * coarse.height);
      const TexelRegion all{0, 0, coarse.width, coarse.height};
      CHECK(covered(all, coarse, fine).width() == fine.width);
      reduce(texels, fine, all, coarse, 1, next);
      double of_next = 0;
      for (float value : next) of_next += value / static_cast<double>(next.size());
      CHECK(of_next == doctest::Approx(mean).epsilon(1e-6));
      texels = std::move(next);
      fine = coarse;
    }
  }
}

TEST_CASE("texture: a footprint gives the mean of what it covers") {
  const pictures::Folder folder;
  constexpr int kSide = 256;
  // Smooth over many texels, with noise within them.
  const pictures::Texel texel = [](int x, int y, int c) {
    return 0.5f + 0.3f * std::sin(x * 0.03f) * std::cos(y * 0.05f) + 0.2f * (noise(x, y, c) - 0.5f);
  };
  const std::string path = folder.write("a.exr", kSide, kSide, 1, texel);
  const TextureCache cache({texture(path, TextureWrap::kRepeat)}, {});
  for (const auto& [width_s, width_t] :
       {std::pair(0.125f, 0.125f), std::pair(0.03f, 0.25f), std::pair(0.25f, 0.02f)}) {
    double worst = 0;
    for (float s : {0.3f, 0.5f, 0.7f})
      for (float t : {0.3f, 0.6f}) {
        const double expected = slow_mean(texel, kSide, kSide, s - width_s / 2, s + width_s / 2,
                                          t - width_t / 2, t + width_t / 2);
        worst = std::max(worst, std::abs(read(cache, {s, t, width_s, 0, 0, width_t})[0] - expected));
      }
    CHECK(worst < 0.03);  // the filter is no box: a tenth of what the picture varies by
  }
}

TEST_CASE("texture: a long footprint is filtered along its axis, not across") {
  const pictures::Folder folder;
  // Stripes along t, four texels wide: a footprint along t keeps them, one along s does not.
  const std::string path =
      folder.write("a.exr", 256, 256, 1, [](int x, int, int) { return x / 4 % 2 ? 1.0f : 0.0f; });
  const TextureCache cache({texture(path, TextureWrap::kRepeat)}, {});
  const float s = (128 + 6.0f) / 256, texel = 1.0f / 256;
  CHECK(read(cache, {s, 0.5f, texel, 0, 0, 16 * texel})[0] > 0.9f);
  CHECK(read(cache, {s, 0.5f, 32 * texel, 0, 0, texel})[0] == doctest::Approx(0.5).epsilon(0.1));
  CHECK(read(cache, {s, 0.5f, 0, 16 * texel, texel, 0})[0] > 0.9f);  // the axes' order does not matter
}

TEST_CASE("texture: a chequerboard of sRGB seen from afar is the mean of linear light") {
  const pictures::Folder folder;
  const pictures::Texel board = [](int x, int y, int c) { return c == 3 || (x + y) % 2 ? 1.0f : 0.0f; };
  for (const char* name : {"a.png", "a.tif"}) {
    const std::string path = folder.write(name, 64, 64, 3, board, {.type = OIIO::TypeUInt8});
    ImageTexture srgb = texture(path, TextureWrap::kRepeat), raw = srgb;
    srgb.color_space = "auto";
    const TextureCache cache({srgb, raw}, {});
    for (TextureId id : {0u, 1u})
      CHECK(read(cache, {0.3f, 0.4f, 0.5f, 0, 0, 0.5f}, id)[0] == doctest::Approx(0.5).epsilon(1e-3));
    // 0.2 and 0.8: the mean of the encoded values would be another.
  }
  const std::string grey =
      folder.write("b.png", 64, 64, 3, [](int x, int y, int) { return (x + y) % 2 ? 0.8f : 0.2f; },
                   {.type = OIIO::TypeUInt8});
  ImageTexture srgb = texture(grey, TextureWrap::kRepeat);
  srgb.color_space = "sRGB";
  const TextureCache cache({srgb}, {});
  const double expected = (linear_of_srgb(0.2) + linear_of_srgb(0.8)) / 2;
  CHECK(read(cache, {0.3f, 0.4f, 0.5f, 0, 0, 0.5f})[0] == doctest::Approx(expected).epsilon(1e-3));
}

TEST_CASE("texture: colour spaces") {
  const pictures::Folder folder;
  const pictures::Texel ramp = [](int x, int, int) { return x / 255.0f; };
  const std::string eight = folder.write("a.png", 256, 1, 4, ramp, {.type = OIIO::TypeUInt8});
  const std::string grey = folder.write("b.png", 256, 1, 1, ramp, {.type = OIIO::TypeUInt8});
  const std::string sixteen = folder.write("c.png", 256, 1, 3, ramp, {.type = OIIO::TypeUInt16});
  const std::string linear =
      folder.write("d.png", 256, 1, 3, ramp, {.type = OIIO::TypeUInt8, .color_space = "lin_rec709_scene"});
  const auto worst = [&](const std::string& path, const std::string& space, auto&& expected) {
    ImageTexture spaced = texture(path);
    spaced.color_space = space;
    const TextureCache cache({spaced}, {});
    double found = 0;
    for (int x = 0; x < 256; ++x) {
      const TexelColor texel = read_texel(cache, x, 0, 256, 1);
      for (int c = 0; c < 3; ++c)
        found =
            std::max(found, std::abs(texel[c] - expected(x / 255.0)) / std::max(1e-3, expected(x / 255.0)));
    }
    CHECK(cache.faults().empty());
    return found;
  };
  const auto same = [](double value) { return value; };
  constexpr double kHalf = 1.0 / 2048;  // half of a step of half precision
  CHECK(worst(eight, "auto", linear_of_srgb) < kHalf);
  CHECK(worst(eight, "sRGB", linear_of_srgb) < kHalf);
  CHECK(worst(eight, "srgb_tx", linear_of_srgb) < kHalf);
  CHECK(worst(eight, "raw", same) < kHalf);
  CHECK(worst(eight, "", same) < kHalf);
  CHECK(worst(grey, "auto", same) < kHalf);
  CHECK(worst(grey, "sRGB", linear_of_srgb) < kHalf);
  CHECK(worst(sixteen, "auto", same) < 1e-3);  // a step of 16 bits where values are near 0.001
  CHECK(worst(linear, "auto", same) < kHalf);
  CHECK(worst(eight, "g22_rec709_scene", [](double v) { return std::pow(v, 2.2); }) < 2e-3);
  // White stays 1, alpha is not converted, and is not multiplied into anything.
  ImageTexture spaced = texture(eight);
  spaced.color_space = "auto";
  const TextureCache cache({spaced}, {});
  CHECK(read_texel(cache, 255, 0, 256, 1) == TexelColor{1, 1, 1, 1});
  CHECK(read_texel(cache, 51, 0, 256, 1)[3] == doctest::Approx(0.2).epsilon(kHalf));
}

TEST_CASE("texture: into another rendering space") {
  const pictures::Folder folder;
  const std::string path =
      folder.write("a.exr", 2, 2, 3, [](int, int, int c) { return c == 0 ? 1.0f : 0.0f; });
  ImageTexture red = texture(path);
  red.color_space = "lin_rec709_scene";
  const TextureCache cache({red}, {.rendering_space = "acescg"});
  // The first column of the matrix from linear Rec. 709 to ACEScg (Bradford), as the ACES config states it.
  const TexelColor found = read_point(cache, 0.5f, 0.5f);
  CHECK(found[0] == doctest::Approx(0.6131324).epsilon(1e-4));
  CHECK(found[1] == doctest::Approx(0.0701934).epsilon(1e-4));
  CHECK(found[2] == doctest::Approx(0.0206155).epsilon(1e-4));
}

TEST_CASE("texture: channels") {
  const pictures::Folder folder;
  const auto texel = [](int, int, int c) { return 0.125f * (c + 1); };
  const auto found = [&](int channels) {
    return read_point(TextureCache({texture(folder.write("a.tif", 4, 4, channels, texel))}, {}), 0.5f, 0.5f);
  };
  CHECK(found(1) == TexelColor{0.125f, 0.125f, 0.125f, 1});
  CHECK(found(2) == TexelColor{0.125f, 0.125f, 0.125f, 0.25f});
  CHECK(found(3) == TexelColor{0.125f, 0.25f, 0.375f, 1});
  CHECK(found(4) == TexelColor{0.125f, 0.25f, 0.375f, 0.5f});
}

TEST_CASE("texture: UDIM tiles cover their squares and nothing else") {
  const pictures::Folder folder;
  const auto flat = [](float value) { return [value](int, int, int) { return value; }; };
  ImageTexture udim;
  udim.udim = true;
  udim.fallback = {0.9f, 0.8f, 0.7f, 0.6f};
  udim.tiles = {{1, 1, {folder.write("1012.exr", 8, 8, 3, flat(0.75f)), 0, 0}},
                {0, 0, {folder.write("1001.exr", 8, 8, 3, flat(0.25f)), 0, 0}},
                {1, 0, {folder.write("1002.exr", 4, 4, 3, flat(0.5f)), 0, 0}}};
  const TextureCache cache({udim}, {});
  for (float inside : {0.0f, 0.4f, 0.99f}) {
    CHECK(read_point(cache, inside, inside)[0] == 0.25f);
    CHECK(read_point(cache, 1 + inside, inside)[0] == 0.5f);
    CHECK(read_point(cache, 1 + inside, 1 + inside)[0] == 0.75f);
    CHECK(read_point(cache, inside, 1 + inside) == udim.fallback);
    CHECK(read_point(cache, inside - 1, inside) == udim.fallback);
  }
  CHECK(read(cache, {1.5f, 0.5f, 0.5f, 0, 0, 0.5f})[0] == 0.5f);
  CHECK(cache.faults().empty());
}

TEST_CASE("texture: a part of a file, as a usdz package holds them") {
  const pictures::Folder folder;
  for (const std::string name : {"a.png", "a.jpg", "a.exr", "a.tif"}) {
    CAPTURE(name);
    const std::string path = folder.write(
        name, 32, 32, 3, [](int x, int, int) { return x < 16 ? 0.0f : 1.0f; }, {.type = OIIO::TypeUInt8});
    const std::string part = pictures::bytes_of(path);
    const std::string package =
        folder.write_bytes("package.usdz", std::string(1234, 'x') + part + std::string(777, 'y'));
    ImageTexture packed = texture(package);
    packed.tiles[0].file.offset = 1234;
    packed.tiles[0].file.bytes = part.size();
    const TextureCache cache({packed, texture(path)}, {});
    for (float s : {0.1f, 0.9f}) CHECK(read_point(cache, s, 0.5f) == read_point(cache, s, 0.5f, 1));
    CHECK(read_point(cache, 0.9f, 0.5f)[0] > 0.95f);
    for (const TextureFault& fault : cache.faults()) FAIL_CHECK(fault.reason);
  }
}

TEST_CASE("texture: 16 threads find what one does, within the memory limit") {
  const pictures::Folder folder;
  constexpr int kSide = 512, kThreads = 16, kQueries = 500;
  std::vector<ImageTexture> textures;
  for (int i = 0; i < 4; ++i) {
    const auto texel = [i](int x, int y, int c) {
      return 0.5f + 0.5f * std::sin(0.01f * (x + 2 * y + 100 * i) + static_cast<float>(c));
    };
    textures.push_back(texture(folder.write(std::to_string(i) + ".exr", kSide, kSide, 4, texel, {.tile = 64}),
                               TextureWrap::kRepeat));
  }
  // Together 22 MB of tiles with their levels. The slack: each thread makes a tile of each level at a time.
  constexpr std::uint64_t kLimit = 11u << 20, kSlack = 8u << 20;
  const auto queries = [](int thread) {
    std::mt19937 generator(static_cast<unsigned>(thread));
    std::uniform_real_distribution<float> place(0, 1), size(-10, -2);
    std::vector<TextureQuery> result;
    for (int i = 0; i < kQueries; ++i) {
      const float width = std::exp2(size(generator));
      result.push_back({place(generator), place(generator), width, 0, 0, width});
    }
    return result;
  };
  const auto ask = [&](const TextureCache& cache, int thread) {
    std::vector<TexelColor> result(kQueries);
    cache.read(static_cast<TextureId>(thread % 4), queries(thread), result);
    return result;
  };
  const TextureCache alone(textures, {}), shared(textures, {.memory_limit_bytes = kLimit});
  std::vector<std::vector<TexelColor>> found(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back([&, i] { found[i] = ask(shared, i); });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < kThreads; ++i) CHECK(found[i] == ask(alone, i));
  const TextureStatistics statistics = shared.statistics();
  CHECK(statistics.lookups == kThreads * kQueries);
  CHECK(statistics.files == 4);
  CHECK(statistics.bytes_read > 0);
  CHECK(statistics.peak_memory_bytes <= kLimit + kSlack);
  CHECK(alone.statistics().peak_memory_bytes > kLimit + kSlack);
}
