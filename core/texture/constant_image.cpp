#include "core/texture/constant_image.h"

#include <OpenImageIO/texture.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

#include "core/base/error.h"
#include "core/texture/picture_file.h"

namespace msbvh {
namespace {

constexpr int kRowsAtOnce = 64;

// Of all levels that a file has; none: they differ, or one is not finite.
std::optional<std::vector<float>> common_texel(PictureFile& file) {
  const auto channels = static_cast<std::size_t>(file.channels());
  std::vector<float> first, texels;
  const auto differs = [&](int level, const TexelRegion& region) {
    texels.resize(static_cast<std::size_t>(region.width()) * region.height() * channels);
    file.read(level, region, texels);
    if (first.empty()) first.assign(texels.begin(), texels.begin() + channels);
    for (std::size_t i = 0; i < texels.size(); ++i)
      if (!(texels[i] == first[i % channels])) return true;
    return false;
  };
  const std::vector<LevelSize>& levels = file.levels();
  for (int level = 0; level < static_cast<int>(levels.size()); ++level) {
    const LevelSize size = levels[level];
    const bool tiled = file.access() == PictureAccess::kTiles;
    const int wide = tiled ? file.tile().width : size.width;
    // Most images differ in their first row.
    if (level == 0 && !tiled && differs(0, {0, 0, size.width, 1})) return std::nullopt;
    const int high = tiled ? file.tile().height : kRowsAtOnce;
    for (int y = 0; y < size.height; y += high)
      for (int x = 0; x < size.width; x += wide)
        if (differs(level, {x, y, std::min(x + wide, size.width), std::min(y + high, size.height)}))
          return std::nullopt;
  }
  const bool finite = std::all_of(first.begin(), first.end(), [](float x) { return std::isfinite(x); });
  return finite && file.fault().empty() ? std::optional(first) : std::nullopt;
}

struct Found {
  std::optional<TexelColor> color;
  TexelColor black{};  // what wraps to black give
  bool wraps_to_black[2] = {false, false};
};

Found look_at(const TextureFile& file, const std::string& color_space, const std::string& rendering_space) {
  TexelMemory memory(0);  // rows are read from the top, and none is held
  PictureFile picture(file, color_space, rendering_space, memory);
  const LevelSize size = picture.levels().front();
  if (std::uint64_t(size.width) * std::uint64_t(size.height) > kMostTexelsToCompare) return {};
  const std::optional<std::vector<float>> texel = common_texel(picture);
  if (!texel) return {};
  const std::vector<float>& t = *texel;
  Found found;
  found.color = t.size() < 3 ? TexelColor{t[0], t[0], t[0], t.size() == 2 ? t[1] : 1.0f}
                             : TexelColor{t[0], t[1], t[2], t.size() == 4 ? t[3] : 1.0f};
  found.black[3] = t.size() % 2 == 0 ? 0.0f : 1.0f;
  OIIO::Tex::Wrap s = OIIO::Tex::Wrap::Black, t_wrap = OIIO::Tex::Wrap::Black;
  if (!picture.wrap_modes().empty()) OIIO::Tex::parse_wrapmodes(picture.wrap_modes().c_str(), s, t_wrap);
  const auto is_black = [](OIIO::Tex::Wrap wrap) {
    return wrap == OIIO::Tex::Wrap::Black || wrap == OIIO::Tex::Wrap::Default;
  };
  found.wraps_to_black[0] = is_black(s);
  found.wraps_to_black[1] = is_black(t_wrap);
  return found;
}

// Remembered: the frames of a run read the same materials again.
Found found_in(const TextureFile& file, const std::string& color_space, const std::string& rendering_space) {
  using Key = std::tuple<std::string, std::uint64_t, std::uint64_t, std::string, std::string,
                         std::filesystem::file_time_type>;
  static std::mutex mutex;
  static std::map<Key, Found> known;
  std::error_code error;
  const Key key{file.path,   file.offset,     file.bytes,
                color_space, rendering_space, std::filesystem::last_write_time(file.path, error)};
  const std::lock_guard lock(mutex);
  const auto [at, is_new] = known.try_emplace(key);
  if (is_new) {
    try {
      at->second = look_at(file, color_space, rendering_space);
    } catch (const Error&) {
      // The cache meets it too, and says so.
    }
  }
  return at->second;
}

}  // namespace

std::optional<TexelColor> constant_color(const ImageTexture& texture, const std::string& rendering_space) {
  if (texture.udim || texture.tiles.size() != 1) return std::nullopt;
  const Found found = found_in(texture.tiles.front().file, texture.color_space, rendering_space);
  if (!found.color) return std::nullopt;
  const auto black = [](TextureWrap wrap, bool of_file) {
    return wrap == TextureWrap::kBlack || (wrap == TextureWrap::kMetadata && of_file);
  };
  const bool outside_is_black =
      black(texture.wrap_s, found.wraps_to_black[0]) || black(texture.wrap_t, found.wraps_to_black[1]);
  return outside_is_black && *found.color != found.black ? std::nullopt : found.color;
}

}  // namespace msbvh
