// One opened image file: its texels by level and region, as floats in the rendering space.
#pragma once

#include <OpenImageIO/imageio.h>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/texture/color_conversion.h"
#include "core/texture/file_part.h"
#include "core/texture/image_texture.h"
#include "core/texture/reduce.h"
#include "core/texture/texel_memory.h"

namespace msbvh {

// How its texels come from the file. Formats of rows (PNG, JPEG, most EXR) can be read from the top only.
enum class PictureAccess {
  kTiles,  // each where it is asked for
  kWhole,  // decoded once, and held
  kStrips  // too large to hold: the last few rows of tiles are; going back decodes from the top
};

class PictureFile {
 public:
  // Opens it. Throws Error with what is wrong with it, without its name.
  PictureFile(const TextureFile& file, const std::string& color_space, const std::string& rendering_space,
              TexelMemory& memory);
  ~PictureFile();
  PictureFile(const PictureFile&) = delete;
  PictureFile& operator=(const PictureFile&) = delete;

  // 1: grey, 2: grey and alpha, 3: red, green, blue, 4: and alpha.
  int channels() const { return channels_; }
  // Finest first: those that the file has, one at least.
  const std::vector<LevelSize>& levels() const { return levels_; }
  // In which it is best read, of its own where it has tiles.
  LevelSize tile() const { return tile_; }
  // Half precision holds what the file does, to half of a step of 8 bits at white and better below.
  bool fits_half() const { return fits_half_; }
  // As the file says, "black" and the like for each axis with a comma between; empty: nothing.
  const std::string& wrap_modes() const { return wrap_modes_; }
  PictureAccess access() const { return access_; }

  // `result`: rows of `region`, which is of whole tiles or ends where the level does. Texels that cannot be
  // read are NaN; fault() says why. Thread-safe.
  void read(int level, const TexelRegion& region, std::span<float> result);
  // Of the first part that could not be read; empty: none.
  std::string fault() const;

 private:
  // Rows [first, end) as the file stores them.
  struct Strip {
    int first, end;
    std::vector<std::byte> rows;
    std::vector<bool> unreadable;
  };

  void open(const TextureFile& file);
  void open_part(const TextureFile& file, const OIIO::ImageSpec& wanted);
  void check(const OIIO::ImageSpec& spec) const;
  void choose_access(const OIIO::ImageSpec& spec);
  void read_tiles(int level, const TexelRegion& region, std::span<float> result);
  void read_rows(const TexelRegion& region, std::span<float> result);
  const Strip& strip_with(int y0, int y1);
  Strip load(int y0, int y1);
  bool decode(int y0, int y1, std::byte* rows);
  void set_fault(const std::string& reason);
  std::size_t row_bytes() const;

  TexelMemory& memory_;
  std::vector<std::byte> jpeg_;                      // of a package
  std::unique_ptr<OIIO::Filesystem::IOProxy> part_;  // outlives what reads from it
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;  // of the finest level
  ColorConversion conversion_{"", ""};
  int channels_ = 0;
  std::vector<LevelSize> levels_;
  LevelSize tile_{64, 64};
  bool fits_half_ = false;
  std::string wrap_modes_;
  PictureAccess access_ = PictureAccess::kTiles;

  mutable std::mutex mutex_;  // guards what follows
  std::string fault_;
  std::deque<Strip> strips_;  // the one read last comes first
};

}  // namespace msbvh
