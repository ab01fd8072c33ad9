#include "delegate/translate/look/udim.h"

namespace msbvh::translate {
namespace {

// Tile 1001 covers the unit square, ten of them make a row.
constexpr int kFirstTile = 1001, kTilesARow = 10, kLastTile = 1100;
constexpr std::string_view kTileToken = "<UDIM>";

}  // namespace

bool is_tiled(const Asset& asset) { return asset.path.find(kTileToken) != std::string::npos; }

std::optional<TilePlace> tile_place(const Asset& asset, std::string_view file) {
  const std::string_view path = asset.path;
  const std::string_view after = path.substr(path.find(kTileToken) + kTileToken.size());
  while (file.ends_with(']') && !after.ends_with(']')) file.remove_suffix(1);  // in a package
  constexpr std::size_t kDigits = 4;
  if (!file.ends_with(after) || file.size() < after.size() + kDigits) return std::nullopt;
  file.remove_suffix(after.size());
  int number = 0;
  for (const char c : file.substr(file.size() - kDigits)) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + (c - '0');
  }
  if (number < kFirstTile || number > kLastTile) return std::nullopt;
  const int index = number - kFirstTile;
  return TilePlace{index % kTilesARow, index / kTilesARow};
}

}  // namespace msbvh::translate
