#include "delegate/hydra/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <pxr/base/gf/half.h>
#include <pxr/imaging/hio/image.h>
#include <pxr/imaging/hio/types.h>
#include <pxr/usd/ar/packageUtils.h>
#include <vector>

namespace msbvh::hydra {
namespace {

using translate::ScalarImage;

// An image as linear numbers, [height][width][channels].
struct Texels {
  std::uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  std::vector<float> values{};
};

// IEC 61966-2-1.
double linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((std::max(encoded, 0.0) + 0.055) / 1.055, 2.4);
}

std::optional<float> number_at(const unsigned char* bytes, HioType type, std::size_t index) {
  switch (type) {
    case HioTypeUnsignedByte:
    case HioTypeUnsignedByteSRGB:
      return float(bytes[index]) / 255.0f;
    case HioTypeUnsignedShort:
      return float(reinterpret_cast<const std::uint16_t*>(bytes)[index]) / 65535.0f;
    case HioTypeHalfFloat:
      return float(reinterpret_cast<const GfHalf*>(bytes)[index]);
    case HioTypeFloat:
      return reinterpret_cast<const float*>(bytes)[index];
    default:
      return std::nullopt;
  }
}

// sRGB where there are 8 bits and three or four channels, unless the network says otherwise.
bool is_srgb(std::string_view colour_space, HioType type, std::size_t channels) {
  const bool bytes = type == HioTypeUnsignedByte || type == HioTypeUnsignedByteSRGB;
  return colour_space == "sRGB" || (colour_space != "raw" && bytes && channels >= 3);
}

std::optional<Texels> read(const std::string& file, std::string_view colour_space) {
  const HioImageSharedPtr image = HioImage::OpenForReading(file, 0, 0, HioImage::Raw, true);
  if (!image || image->GetWidth() <= 0 || image->GetHeight() <= 0) return std::nullopt;
  const HioFormat format = image->GetFormat();
  const HioType type = HioGetHioType(format);
  Texels texels{std::uint32_t(image->GetWidth()),
                std::uint32_t(image->GetHeight()),
                std::size_t(HioGetComponentCount(format)),
                {}};
  std::vector<unsigned char> bytes(std::size_t(texels.width) * texels.height *
                                   std::size_t(image->GetBytesPerPixel()));
  HioImage::StorageSpec storage;
  storage.width = image->GetWidth();
  storage.height = image->GetHeight();
  storage.depth = 1;
  storage.format = format;
  storage.data = bytes.data();
  if (!image->Read(storage)) return std::nullopt;
  const bool srgb = is_srgb(colour_space, type, texels.channels);
  texels.values.resize(std::size_t(texels.width) * texels.height * texels.channels);
  for (std::size_t i = 0; i < texels.values.size(); ++i) {
    const std::optional<float> value = number_at(bytes.data(), type, i);
    if (!value) return std::nullopt;
    const bool alpha =
        (texels.channels == 2 || texels.channels == 4) && i % texels.channels == texels.channels - 1;
    texels.values[i] = srgb && !alpha ? float(linear(double(*value))) : *value;
  }
  return texels;
}

// Of red, green, blue and alpha among the channels of an image; none: it has no alpha.
std::optional<std::size_t> place_of(std::size_t channel, std::size_t count) {
  if (channel == 3) return count == 2 || count == 4 ? std::optional(count - 1) : std::nullopt;
  return count < 3 ? 0 : channel;
}

}  // namespace

// Packages within packages are looked through; none for what is compressed or encrypted.
std::optional<TextureFile> Textures::locate(const std::string& file) const {
  if (!ArIsPackageRelativePath(file)) return TextureFile{file};
  auto [package, inner] = ArSplitPackageRelativePathOuter(file);
  TextureFile found{package};
  std::string opened = package;
  while (!inner.empty()) {
    const auto [name, rest] = ArIsPackageRelativePath(inner) ? ArSplitPackageRelativePathOuter(inner)
                                                             : std::pair(inner, std::string());
    const ZipFile archive = ZipFile::Open(opened);
    if (!archive) return std::nullopt;
    const auto entry = archive.Find(name);
    if (entry == archive.end()) return std::nullopt;
    const auto info = entry.GetFileInfo();
    if (info.compressionMethod != 0 || info.encrypted) return std::nullopt;
    found.offset += info.dataOffset;
    found.bytes = info.size;
    opened = ArJoinPackageRelativePath(opened, name);
    inner = rest;
  }
  return found;
}

std::optional<ScalarImage> Textures::channel(const translate::Asset& texture, std::string_view colour_space,
                                             std::size_t channel) const {
  if (texture.files.empty()) return std::nullopt;
  const std::optional<Texels> texels = read(texture.files.front(), colour_space);
  if (!texels) return std::nullopt;
  ScalarImage image{texels->width, texels->height,
                    std::vector<float>(std::size_t(texels->width) * texels->height, 1.0f)};
  const std::optional<std::size_t> place = place_of(channel, texels->channels);
  for (std::size_t i = 0; place && i < image.values.size(); ++i)
    image.values[i] = texels->values[i * texels->channels + *place];
  return image;
}

std::optional<translate::ColourImage> Textures::colours(const translate::Asset& texture,
                                                        std::string_view colour_space) const {
  if (texture.files.empty()) return std::nullopt;
  const std::optional<Texels> texels = read(texture.files.front(), colour_space);
  if (!texels) return std::nullopt;
  translate::ColourImage image{texels->width, texels->height, {}};
  image.texels.reserve(std::size_t(texels->width) * texels->height);
  for (std::size_t i = 0; i < texels->values.size(); i += texels->channels) {
    const float* v = &texels->values[i];
    image.texels.push_back(texels->channels >= 3 ? Vec3f{v[0], v[1], v[2]} : Vec3f{v[0], v[0], v[0]});
  }
  return image;
}

}  // namespace msbvh::hydra
