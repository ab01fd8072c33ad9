// Texture files that are missing, damaged, hostile, of another kind or very large: one fault that says so,
// the fallback, and no value that is not finite.
#include <OpenImageIO/deepdata.h>
#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/texture/texture_cache.h"
#include "tests/support/picture_files.h"

using namespace msbvh;

namespace {

constexpr TexelColor kFallback{0.1f, 0.2f, 0.3f, 0.4f};

ImageTexture texture(const std::string& path) {
  ImageTexture result;
  result.tiles = {{0, 0, {path, 0, 0}}};
  result.wrap_s = result.wrap_t = TextureWrap::kClamp;
  result.fallback = kFallback;
  return result;
}

TexelColor read(const TextureCache& cache, float s, float t, float width = 0) {
  const TextureQuery query{s, t, width, 0, 0, width};
  TexelColor result;
  cache.read(0, std::span(&query, 1), std::span(&result, 1));
  return result;
}

// Reads it all over; every value must be finite. Returns the fault's reason; empty: there is none.
std::string fault_of(const TextureCache& cache) {
  for (float s : {0.1f, 0.5f, 0.9f})
    for (float t : {0.1f, 0.5f, 0.9f})
      for (float width : {0.0f, 0.1f, 1.0f})
        for (float value : read(cache, s, t, width)) CHECK(std::isfinite(value));
  const std::vector<TextureFault> faults = cache.faults();
  CHECK(faults.size() <= 1);
  return faults.empty() ? "" : faults[0].reason;
}

std::string fault_of(const std::string& path) { return fault_of(TextureCache({texture(path)}, {})); }

float ramp(int x, int y, int) { return static_cast<float>((x * 7 + y * 13) % 256) / 255.0f; }

void write_deep(const std::string& path) {
  OIIO::ImageSpec spec(8, 8, 5, OIIO::TypeFloat);
  spec.channelnames = {"R", "G", "B", "A", "Z"};
  spec.deep = true;
  OIIO::DeepData samples(spec);
  for (int i = 0; i < 64; ++i) samples.set_samples(i, 1);
  const auto out = OIIO::ImageOutput::create(path);
  REQUIRE(out->open(path, spec));
  REQUIRE(out->write_deep_image(samples));
  REQUIRE(out->close());
}

}  // namespace

TEST_CASE("texture fault: what is no image") {
  const pictures::Folder folder;
  CHECK(fault_of(folder / "none.png") == "there is no such file");
  CHECK(fault_of(folder.write_bytes("empty.png", "")) == "the file is empty");
  std::filesystem::create_directory(folder / "folder.png");
  CHECK(fault_of(folder / "folder.png") == "it is a folder, not an image");
  CHECK(
      fault_of(folder.write_bytes("text.png", "not a picture\n")).starts_with("OpenImageIO cannot read it"));
  CHECK(fault_of(folder.write_bytes("text.usda", "#usda 1.0\n")).starts_with("OpenImageIO cannot read it"));
  write_deep(folder / "deep.exr");
  CHECK(fault_of(folder / "deep.exr") == "it holds deep samples; expected an image of one colour a pixel");
}

TEST_CASE("texture fault: the fallback is drawn, and the fault named once however often it is read") {
  const pictures::Folder folder;
  const std::string sound = folder.write("a.exr", 4, 4, 3, ramp);
  const TextureCache cache({texture(folder / "none.png"), texture(sound), texture(folder / "none.png")}, {});
  for (int i = 0; i < 10; ++i) CHECK(read(cache, 0.1f * static_cast<float>(i), 0.5f) == kFallback);
  CHECK(cache.faults().size() == 2);  // of each texture
  CHECK(cache.faults()[0].texture == 0);
  CHECK(cache.faults()[1].texture == 2);
  CHECK(cache.faults()[0].file == folder / "none.png");
}

TEST_CASE("texture fault: nothing is opened before it is read") {
  const TextureCache cache({texture("/nonexistent.png")}, {});
  CHECK(cache.faults().empty());
}

TEST_CASE("texture fault: files cut short at any place") {
  const pictures::Folder folder;
  for (const std::string name : {"a.png", "a.jpg", "a.exr", "a.tif", "b.exr", "b.tif"}) {
    CAPTURE(name);
    const pictures::Format format{.type = name[2] == 'e' ? OIIO::TypeHalf : OIIO::TypeUInt8,
                                  .tile = name[0] == 'b' ? 32 : 0};
    const std::string bytes = pictures::bytes_of(folder.write(name, 128, 128, 3, ramp, format));
    int faults = 0;
    for (double share : {0.001, 0.01, 0.1, 0.3, 0.5, 0.8, 0.95}) {
      const auto length = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
      faults += !fault_of(folder.write_bytes("cut_" + name, bytes.substr(0, length))).empty();
    }
    CHECK(faults >= (name == "a.jpg" ? 2 : 6));  // libjpeg fills in what is missing, and says nothing
  }
}

TEST_CASE("texture fault: files with bytes that were changed") {
  const pictures::Folder folder;
  for (const std::string name : {"a.png", "a.jpg", "a.exr", "a.tif", "b.exr", "a.hdr"}) {
    const pictures::Format format{.type = name[2] == 'e' ? OIIO::TypeHalf : OIIO::TypeUInt8,
                                  .tile = name[0] == 'b' ? 32 : 0};
    const std::string bytes = pictures::bytes_of(folder.write(name, 64, 64, 3, ramp, format));
    for (unsigned i = 0; i < 40; ++i) {
      std::string changed = bytes;
      // Headers half of the time: that is where sizes are.
      const std::size_t place =
          (i * 2654435761u) % (i % 2 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
      changed[place] = static_cast<char>(changed[place] ^ (1 << i % 8));
      fault_of(folder.write_bytes("changed_" + name, changed));
    }
  }
}

TEST_CASE("texture fault: a texel that is not finite spoils what it is in, and no more") {
  const pictures::Folder folder;
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    for (int tile : {0, 32}) {
      const std::string path =
          folder.write("a.exr", 256, 256, 3,
                       [&](int x, int y, int) { return x == 200 && y == 50 ? bad : 0.5f; }, {.tile = tile});
      for (const std::string space : {"", "sRGB", "lin_rec709_scene"}) {
        ImageTexture spaced = texture(path);
        spaced.color_space = space;
        const TextureCache cache({spaced}, {.rendering_space = "acescg"});
        CHECK(read(cache, 200.5f / 256, 1 - 50.5f / 256) == kFallback);
        CHECK(read(cache, 0.5f, 0.5f, 1.0f) == kFallback);
        CHECK(read(cache, 0.1f, 0.1f)[0] > 0.1f);
        CHECK(read(cache, 0.1f, 0.1f)[0] < 0.6f);
        CHECK(cache.faults().size() == 1);
        CHECK(cache.faults()[0].reason == "a texel is not finite");
      }
    }
  }
}

TEST_CASE("texture fault: what is finite stays so") {
  const pictures::Folder folder;
  const float largest = std::numeric_limits<float>::max();
  const std::string half = folder.write(
      "a.exr", 4, 4, 3, [](int, int, int c) { return c ? -65000.0f : 65000.0f; }, {.type = OIIO::TypeHalf});
  const std::string full = folder.write("b.exr", 4, 4, 3, [&](int, int, int) { return largest; });
  ImageTexture spaced = texture(half);
  spaced.color_space = "acescg";
  CHECK(fault_of(TextureCache({spaced}, {})).empty());  // brighter than half precision holds
  CHECK(fault_of(full).empty());
}

TEST_CASE("texture fault: colour spaces that are none") {
  const pictures::Folder folder;
  ImageTexture spaced = texture(folder.write("a.exr", 4, 4, 3, ramp));
  spaced.color_space = "ultraviolet";
  const std::string reason = fault_of(TextureCache({spaced}, {}));
  CHECK(reason.starts_with("colour space 'ultraviolet': found no such name; expected"));
  CHECK_THROWS_AS(TextureCache({spaced}, {.rendering_space = "infrared"}), Error);
}

TEST_CASE("texture fault: parts of packages that are not there") {
  const pictures::Folder folder;
  const std::string path = folder.write("a.png", 8, 8, 3, ramp, {.type = OIIO::TypeUInt8});
  ImageTexture packed = texture(path);
  packed.tiles[0].file.bytes = 10;
  CHECK_FALSE(fault_of(TextureCache({packed}, {})).empty());
  packed.tiles[0].file = {path, 1u << 30, 100};
  CHECK_FALSE(fault_of(TextureCache({packed}, {})).empty());
}

TEST_CASE("texture: a picture of 20,000 texels a side is read by tiles") {
  const pictures::Folder folder;
  constexpr int kSide = 20000, kTile = 256;
  const std::string path = folder / "huge.tif";
  OIIO::ImageSpec spec(kSide, kSide, 1, OIIO::TypeUInt8);
  spec.tile_width = spec.tile_height = kTile;
  spec.attribute("compression", "packbits");
  const auto out = OIIO::ImageOutput::create(path);
  REQUIRE(out->open(path, spec));
  for (int y = 0; y < kSide; y += kTile) {
    for (int x = 0; x < kSide; x += kTile) {
      const std::vector<std::uint8_t> texels(kTile * kTile, static_cast<std::uint8_t>(x / kTile));
      REQUIRE(out->write_tile(x, y, 0, OIIO::TypeUInt8, texels.data()));
    }
  }
  REQUIRE(out->close());
  constexpr std::uint64_t kLimit = 32u << 20;
  const TextureCache cache({texture(path)}, {.memory_limit_bytes = kLimit});
  for (int column : {0, 20, 70}) {
    for (int row : {10, 60}) {
      const auto at = [](int tile) { return (static_cast<float>(tile * kTile) + 100.5f) / kSide; };
      CHECK(read(cache, at(column), 1 - at(row))[0] == doctest::Approx(column / 255.0).epsilon(1e-3));
    }
  }
  CHECK(cache.faults().empty());
  CHECK(cache.statistics().bytes_read == 6 * kTile * kTile);
  CHECK(cache.statistics().peak_memory_bytes < kLimit);
}

TEST_CASE("texture: a picture of rows that is too large to hold is read by strips, and the same") {
  const pictures::Folder folder;
  const std::string path = folder.write("a.png", 3000, 2000, 3, ramp, {.type = OIIO::TypeUInt8});
  const TextureCache whole({texture(path)}, {}), strips({texture(path)}, {.memory_limit_bytes = 12u << 20});
  for (float t : {0.05f, 0.95f, 0.5f, 0.06f})
    for (float s : {0.2f, 0.8f}) CHECK(read(whole, s, t, 0.002f) == read(strips, s, t, 0.002f));
  CHECK(strips.faults().empty());
  CHECK(strips.statistics().peak_memory_bytes < whole.statistics().peak_memory_bytes);
}
