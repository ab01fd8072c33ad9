// UDIM textures: files that cover a unit square of texture coordinates each.
#pragma once

#include <optional>
#include <string_view>

#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

bool is_tiled(const Asset& asset);

struct TilePlace {
  int s, t;  // the lower left corner
};
// Of a tile's file, by the digits that stand for the token in the asset's path. None: it is no tile.
std::optional<TilePlace> tile_place(const Asset& asset, std::string_view file);

}  // namespace msbvh::translate
