// Pictures that tests of textures read: written to a folder that goes with the test.
#pragma once

#include <OpenImageIO/imageio.h>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pictures {

// x and y from the upper left.
using Texel = std::function<float(int x, int y, int channel)>;

struct Format {
  OIIO::TypeDesc type = OIIO::TypeFloat;
  int tile = 0;  // 0: rows
  std::string color_space{}, wrap_modes{};
};

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "msbvh_textures_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  // Its path. Empty where it could not be written.
  std::string write(const std::string& name, int width, int height, int channels, const Texel& texel,
                    const Format& format = {}) const {
    OIIO::ImageSpec spec(width, height, channels, format.type);
    spec.tile_width = spec.tile_height = format.tile;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!format.color_space.empty()) spec.attribute("oiio:ColorSpace", format.color_space);
    if (!format.wrap_modes.empty()) spec.attribute("wrapmodes", format.wrap_modes);
    std::vector<float> texels;
    texels.reserve(static_cast<std::size_t>(width) * height * channels);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int channel = 0; channel < channels; ++channel) texels.push_back(texel(x, y, channel));
    const std::string path = *this / name;
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    const bool done = out != nullptr && out->open(path, spec) &&
                      out->write_image(OIIO::TypeFloat, texels.data()) && out->close();
    return done ? path : "";
  }

  std::string write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(*this / name, std::ios::binary) << bytes;
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace pictures
