#include "core/texture/picture_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/base/error.h"

namespace msbvh {
namespace {

constexpr int kTileSide = 64;
// Of a file's own tiles: smaller ones cost a read each, larger ones are decoded for a corner of theirs.
constexpr int kSmallestTile = 16, kLargestTile = 256;
// A tile of a coarser level covers three rows of tiles at most.
constexpr std::size_t kStrips = 4;
constexpr int kLargestSide = 1 << 20;

// UsdUVTexture's "auto": sRGB for 8 bits of three or four channels. What the file says decides only against
// it: OpenImageIO says sRGB for every PNG and JPEG, whether they do or not.
std::string resolve_auto(const OIIO::ImageSpec& spec, int channels) {
  if (spec.format != OIIO::TypeUInt8 || channels < 3) return "";
  std::string said = spec.get_string_attribute("oiio:ColorSpace");
  std::transform(said.begin(), said.end(), said.begin(),
                 [](char c) { return static_cast<char>(tolower(c)); });
  return said.starts_with("lin") || said == "raw" || said == "data" ? "" : "sRGB";
}

int used_channels(const OIIO::ImageSpec& spec) {
  if (spec.nchannels <= 4) return spec.nchannels;
  return spec.alpha_channel == 3 ? 4 : 3;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string cannot_read(const std::string& reason) {
  return "OpenImageIO cannot read it: " + first_line(reason);
}

void check_exists(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error("there is no such file");
  if (std::filesystem::is_directory(status)) throw Error("it is a folder, not an image");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) == 0)
    throw Error("the file is empty");
}

}  // namespace

PictureFile::PictureFile(const TextureFile& file, const std::string& color_space,
                         const std::string& rendering_space, TexelMemory& memory)
    : memory_(memory) {
  open(file);
  spec_ = input_->spec();
  check(spec_);
  channels_ = used_channels(spec_);
  const std::string from = color_space == "auto" ? resolve_auto(spec_, channels_) : color_space;
  conversion_ = ColorConversion(from, rendering_space);
  fits_half_ = spec_.format == OIIO::TypeUInt8 || spec_.format == OIIO::TypeHalf;
  wrap_modes_ = spec_.get_string_attribute("wrapmodes");
  levels_ = {{spec_.width, spec_.height}};
  choose_access(spec_);
}

PictureFile::~PictureFile() {
  if (access_ == PictureAccess::kWhole) memory_.release(row_bytes() * spec_.height);
}

void PictureFile::open(const TextureFile& file) {
  check_exists(file.path);
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);  // texels as they are: UsdUVTexture multiplies nothing
  if (file.bytes == 0) {
    input_ = OIIO::ImageInput::open(file.path, &wanted);
    if (input_ == nullptr) throw Error(cannot_read(OIIO::geterror()));
  } else {
    open_part(file, wanted);
  }
  input_->threads(1);  // renderers have threads of their own
}

void PictureFile::open_part(const TextureFile& file, const OIIO::ImageSpec& wanted) {
  auto part = std::make_unique<FilePart>(file.path, file.offset, file.bytes);
  if (!part->opened()) throw Error("the file cannot be opened");
  const std::string format = part->format();
  if (format.empty())
    throw Error("the part of the package is in no format that packages hold: png, jpeg, exr, avif");
  input_ = OIIO::ImageInput::create(format);
  if (input_ == nullptr) throw Error(cannot_read(OIIO::geterror()));
  if (format == "jpeg") {  // its reader takes files and memory alone
    jpeg_.resize(std::min<std::uint64_t>(file.bytes, std::filesystem::file_size(file.path)));
    jpeg_.resize(part->pread(jpeg_.data(), jpeg_.size(), 0));
    part_ = std::make_unique<OIIO::Filesystem::IOMemReader>(jpeg_.data(), jpeg_.size());
  } else {
    part_ = std::move(part);
  }
  OIIO::ImageSpec found;
  if (!input_->set_ioproxy(part_.get()))
    throw Error("OpenImageIO reads no " + format + " from within a package");
  if (!input_->open(file.path, found, wanted)) throw Error(cannot_read(input_->geterror()));
}

void PictureFile::check(const OIIO::ImageSpec& spec) const {
  if (spec.deep) throw Error("it holds deep samples; expected an image of one colour a pixel");
  if (spec.depth > 1) throw Error("it is a volume; expected an image");
  if (spec.width < 1 || spec.height < 1 || spec.width > kLargestSide || spec.height > kLargestSide)
    throw Error("found " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                " texels; expected 1 to " + std::to_string(kLargestSide) + " on each side");
  if (spec.nchannels < 1 || spec.format == OIIO::TypeUnknown) throw Error("it has no channels");
}

void PictureFile::choose_access(const OIIO::ImageSpec& spec) {
  const auto fits = [](int side) { return side >= kSmallestTile && side <= kLargestTile; };
  if (fits(spec.tile_width) && fits(spec.tile_height)) {
    tile_ = {spec.tile_width, spec.tile_height};
    for (int level = 1;; ++level) {
      const OIIO::ImageSpec next = input_->spec_dimensions(0, level);
      const LevelSize size{next.width, next.height}, last = levels_.back();
      const bool coarser = size.width >= 1 && size.height >= 1 && size.width <= last.width &&
                           size.height <= last.height && !(size == last);
      if (!coarser || next.tile_width != tile_.width || next.tile_height != tile_.height ||
          next.nchannels != spec.nchannels)
        break;
      levels_.push_back(size);
    }
    (void)input_->geterror();  // of the level that was not there
    return;
  }
  access_ = memory_.hold(row_bytes() * spec.height) ? PictureAccess::kWhole : PictureAccess::kStrips;
}

std::size_t PictureFile::row_bytes() const {
  return static_cast<std::size_t>(spec_.width) * spec_.nchannels * spec_.format.size();
}

void PictureFile::read(int level, const TexelRegion& region, std::span<float> result) {
  access_ == PictureAccess::kTiles ? read_tiles(level, region, result) : read_rows(region, result);
  if (!std::all_of(result.begin(), result.end(), [](float value) { return std::isfinite(value); })) {
    const std::lock_guard lock(mutex_);
    if (fault_.empty()) fault_ = "a texel is not finite";
  }
  if (conversion_.changes()) conversion_.apply(result, channels_, spec_.format == OIIO::TypeUInt8);
}

void PictureFile::read_tiles(int level, const TexelRegion& region, std::span<float> result) {
  const OIIO::ImageSpec spec = input_->spec_dimensions(0, level);
  const bool done =
      input_->read_tiles(0, level, spec.x + region.x0, spec.x + region.x1, spec.y + region.y0,
                         spec.y + region.y1, 0, 1, 0, channels_, OIIO::TypeFloat, result.data());
  if (done) {
    memory_.count_read(result.size() * spec_.format.size());
    return;
  }
  const std::lock_guard lock(mutex_);
  set_fault(input_->geterror());
  std::fill(result.begin(), result.end(), std::nanf(""));
}

void PictureFile::read_rows(const TexelRegion& region, std::span<float> result) {
  const std::lock_guard lock(mutex_);
  const Strip& strip = strip_with(region.y0, region.y1);
  const std::size_t texel = spec_.nchannels * spec_.format.size(), row = row_bytes();
  std::vector<float> all(static_cast<std::size_t>(region.width()) * spec_.nchannels);
  float* out = result.data();
  for (int y = region.y0; y < region.y1; ++y) {
    const std::byte* from = strip.rows.data() + (y - strip.first) * row + region.x0 * texel;
    OIIO::convert_pixel_values(spec_.format, from, OIIO::TypeFloat, all.data(), static_cast<int>(all.size()));
    const float lost = strip.unreadable[y - strip.first] ? std::nanf("") : 0.0f;
    for (int x = 0; x < region.width(); ++x)
      for (int channel = 0; channel < channels_; ++channel)
        *out++ = all[static_cast<std::size_t>(x) * spec_.nchannels + channel] + lost;
  }
}

const PictureFile::Strip& PictureFile::strip_with(int y0, int y1) {
  const auto found = std::find_if(strips_.begin(), strips_.end(),
                                  [&](const Strip& strip) { return strip.first <= y0 && y1 <= strip.end; });
  if (found != strips_.end()) {
    std::rotate(strips_.begin(), found, found + 1);
    return strips_.front();
  }
  if (access_ == PictureAccess::kWhole) {
    strips_.push_front(load(0, spec_.height));
  } else {
    if (strips_.size() == kStrips) strips_.pop_back();
    const int step = std::max(spec_.tile_height, 1);
    strips_.push_front(load(y0 / step * step, std::min((y1 + step - 1) / step * step, spec_.height)));
  }
  return strips_.front();
}

// In steps, so that what is unreadable is known to a few rows.
PictureFile::Strip PictureFile::load(int y0, int y1) {
  Strip strip{y0, y1, std::vector<std::byte>(row_bytes() * (y1 - y0)), std::vector<bool>(y1 - y0)};
  const int step = std::max(kTileSide, spec_.tile_height);
  for (int y = y0; y < y1; y += step) {
    const int end = std::min(y + step, y1);
    if (decode(y, end, strip.rows.data() + (y - y0) * row_bytes())) {
      memory_.count_read((end - y) * row_bytes());
    } else {
      set_fault(input_->geterror());
      std::fill(strip.unreadable.begin() + (y - y0), strip.unreadable.begin() + (end - y0), true);
    }
  }
  return strip;
}

bool PictureFile::decode(int y0, int y1, std::byte* rows) {
  const int top = spec_.y + y0, bottom = spec_.y + y1;
  if (spec_.tile_width == 0)
    return input_->read_scanlines(0, 0, top, bottom, 0, 0, spec_.nchannels, spec_.format, rows);
  return input_->read_tiles(0, 0, spec_.x, spec_.x + spec_.width, top, bottom, 0, 1, 0, spec_.nchannels,
                            spec_.format, rows);
}

void PictureFile::set_fault(const std::string& reason) {
  if (fault_.empty())
    fault_ =
        "a part cannot be read: " + (reason.empty() ? "OpenImageIO does not say why" : first_line(reason));
}

std::string PictureFile::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

}  // namespace msbvh
