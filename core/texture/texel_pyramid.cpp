#include "core/texture/texel_pyramid.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "core/texture/picture_file.h"
#include "core/texture/reduce.h"

namespace msbvh {
namespace {

constexpr const char* kSource = "msbvh:source";
constexpr float kLargestHalf = 65504.0f;
// Of files that are open; beyond them the one that was not read for longest is closed, and what it holds
// freed.
constexpr int kOpenFiles = 500;
TextureWrap wrap_of(OIIO::Tex::Wrap wrap) {
  switch (wrap) {
    case OIIO::Tex::Wrap::Clamp:
      return TextureWrap::kClamp;
    case OIIO::Tex::Wrap::Periodic:
    case OIIO::Tex::Wrap::PeriodicPow2:
      return TextureWrap::kRepeat;
    case OIIO::Tex::Wrap::Mirror:
      return TextureWrap::kMirror;
    default:
      return TextureWrap::kBlack;
  }
}

// For a thread that frees tiles to come to the end of it.
constexpr int kYields = 64;

void to_half(std::span<float> texels, std::byte* result) {
  for (float& value : texels)
    if (std::isfinite(value)) value = std::clamp(value, -kLargestHalf, kLargestHalf);
  OIIO::convert_pixel_values(OIIO::TypeFloat, texels.data(), OIIO::TypeHalf, result,
                             static_cast<int>(texels.size()));
}

}  // namespace

class TexelPyramid final : public OIIO::ImageInput {
 public:
  static OIIO::ImageInput* create() { return new TexelPyramid; }
  ~TexelPyramid() override { TexelPyramid::close(); }

  const char* format_name() const override { return "texels"; }
  bool open(const std::string&, OIIO::ImageSpec&) override { return false; }  // needs a source
  bool open(const std::string& name, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override;
  bool close() override {
    file_.reset();
    return true;
  }
  int current_subimage() const override { return 0; }
  int current_miplevel() const override { return 0; }
  bool seek_subimage(int subimage, int level) override { return has(subimage, level); }
  OIIO::ImageSpec spec(int subimage, int level) override {
    return has(subimage, level) ? specs_[level] : OIIO::ImageSpec();
  }
  OIIO::ImageSpec spec_dimensions(int subimage, int level) override { return spec(subimage, level); }
  bool read_native_scanline(int, int, int, int, void*) override { return false; }  // it has tiles
  bool read_native_tile(int subimage, int level, int x, int y, int z, void* data) override;

 private:
  bool has(int subimage, int level) const {
    return subimage == 0 && level >= 0 && level < static_cast<int>(specs_.size());
  }
  LevelSize size(int level) const { return {specs_[level].width, specs_[level].height}; }
  void make_specs();
  bool reduce_finer(int level, const TexelRegion& region, std::span<float> result) const;

  const TexelSource* source_ = nullptr;
  std::unique_ptr<PictureFile> file_;
  std::vector<OIIO::ImageSpec> specs_;
};

bool TexelPyramid::open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) {
  const OIIO::ParamValue* parameter = config.find_attribute(kSource, OIIO::TypeDesc::PTR);
  source_ = static_cast<const TexelSource*>(parameter->get<void*>());
  try {
    file_ = std::make_unique<PictureFile>(source_->file_, source_->color_space_, source_->rendering_space_,
                                          source_->store_.memory);
  } catch (const Error& error) {
    source_->add_fault(error.what());
    errorfmt("{}", error.what());
    return false;
  }
  make_specs();
  m_spec = spec = specs_[0];
  return true;
}

// Down to one texel.
void TexelPyramid::make_specs() {
  const OIIO::TypeDesc format = file_->fits_half() ? OIIO::TypeHalf : OIIO::TypeFloat;
  std::vector<LevelSize> sizes = file_->levels();
  while (sizes.back().width > 1 || sizes.back().height > 1) sizes.push_back(next_coarser(sizes.back()));
  specs_.clear();
  for (const LevelSize& size : sizes) {
    OIIO::ImageSpec& spec = specs_.emplace_back(size.width, size.height, file_->channels(), format);
    spec.tile_width = file_->tile().width;
    spec.tile_height = file_->tile().height;
    spec.tile_depth = 1;
    if (!file_->wrap_modes().empty()) spec.attribute("wrapmodes", file_->wrap_modes());
  }
}

bool TexelPyramid::read_native_tile(int subimage, int level, int x, int y, int, void* data) {
  if (!has(subimage, level) || file_ == nullptr) return false;
  const OIIO::ImageSpec& spec = specs_[level];
  const TexelRegion region{x, y, std::min(x + spec.tile_width, spec.width),
                           std::min(y + spec.tile_height, spec.height)};
  std::vector<float> texels(static_cast<std::size_t>(region.width()) * region.height() * spec.nchannels);
  if (level < static_cast<int>(file_->levels().size())) {
    file_->read(level, region, texels);
    if (const std::string fault = file_->fault(); !fault.empty()) source_->add_fault(fault);
  } else if (!reduce_finer(level, region, texels)) {
    return false;
  }
  const std::size_t row = static_cast<std::size_t>(region.width()) * spec.nchannels;
  auto* out = static_cast<std::byte*>(data);
  std::fill_n(out, spec.tile_bytes(), std::byte{0});
  for (int j = 0; j < region.height(); ++j, out += spec.tile_width * spec.pixel_bytes()) {
    const std::span<float> from(texels.data() + j * row, row);
    spec.format == OIIO::TypeHalf
        ? to_half(from, out)
        : static_cast<void>(
              std::copy_n(reinterpret_cast<const std::byte*>(from.data()), row * sizeof(float), out));
  }
  source_->store_.note_memory();
  source_->store_.wait_for_memory();
  return true;
}

// By way of the cache, so that the finer tiles are made once. With a record of its own: the cache expects
// that of the calling thread to be left alone while a tile is read.
bool TexelPyramid::reduce_finer(int level, const TexelRegion& region, std::span<float> result) const {
  OIIO::ImageCache& cache = *source_->store_.cache;
  OIIO::ImageCache::Perthread* thread = nullptr;
  {
    const std::lock_guard lock(source_->mutex_);
    if (!source_->idle_threads_.empty()) {
      thread = source_->idle_threads_.back();
      source_->idle_threads_.pop_back();
    }
  }
  if (thread == nullptr) thread = cache.create_thread_info();
  const TexelRegion below = covered(region, size(level), size(level - 1));
  const int channels = specs_[level].nchannels;
  std::vector<float> fine(static_cast<std::size_t>(below.width()) * below.height() * channels);
  OIIO::ImageCache::ImageHandle* handle = cache.get_image_handle(OIIO::ustring(source_->name_), thread);
  const bool done = cache.get_pixels(handle, thread, 0, level - 1, below.x0, below.x1, below.y0, below.y1, 0,
                                     1, 0, channels, OIIO::TypeFloat, fine.data());
  {
    const std::lock_guard lock(source_->mutex_);
    source_->idle_threads_.push_back(thread);
  }
  if (done) reduce(fine, size(level - 1), region, size(level), channels, result);
  return done;
}

TexelStore::TexelStore(std::uint64_t limit_bytes)
    : memory(limit_bytes), cache(OIIO::ImageCache::create(false)) {
  cache->attribute("max_open_files", kOpenFiles);
  cache->attribute("max_errors_per_file", 1);
  cache->attribute("max_memory_MB", static_cast<float>(limit_bytes / 1048576.0));
  system = OIIO::TextureSystem::create(false, cache);
}

std::uint64_t TexelStore::memory_bytes() const {
  long long cached = 0;
  cache->getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &cached);
  return memory.held_bytes() + static_cast<std::uint64_t>(cached);
}

void TexelStore::note_memory() {
  const std::uint64_t now = memory_bytes();
  std::uint64_t peak = peak_bytes.load();
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {
  }
}

void TexelStore::wait_for_memory() const {
  for (int i = 0; i < kYields && memory_bytes() > memory.limit_bytes(); ++i) std::this_thread::yield();
}

TexelSource::TexelSource(TexelStore& store, std::string name, TextureFile file, std::string color_space,
                         std::string rendering_space)
    : store_(store),
      name_(std::move(name)),
      file_(std::move(file)),
      color_space_(std::move(color_space)),
      rendering_space_(std::move(rendering_space)) {}

bool TexelSource::open() const {
  std::call_once(once_, [this] {
    OIIO::ImageSpec config;
    const void* self = this;
    config.attribute(kSource, OIIO::TypeDesc::PTR, &self);
    if (!store_.cache->add_file(OIIO::ustring(name_), &TexelPyramid::create, &config)) {
      (void)store_.cache->geterror();  // a fault says it
      return;
    }
    spec_ = *store_.cache->imagespec(OIIO::ustring(name_));
    OIIO::Tex::Wrap s = OIIO::Tex::Wrap::Default, t = OIIO::Tex::Wrap::Default;
    OIIO::Tex::parse_wrapmodes(std::string(spec_.get_string_attribute("wrapmodes")).c_str(), s, t);
    wrap_s_ = wrap_of(s);
    wrap_t_ = wrap_of(t);
    handle_ = store_.system->get_texture_handle(OIIO::ustring(name_));
    // What a picture that is held takes is not for tiles.
    const std::uint64_t left = store_.memory.limit_bytes() - store_.memory.held_bytes();
    store_.cache->attribute("max_memory_MB", static_cast<float>(left / 1048576.0));
  });
  return handle_ != nullptr;
}

std::vector<std::string> TexelSource::faults() const {
  const std::lock_guard lock(mutex_);
  return faults_;
}

void TexelSource::add_fault(const std::string& reason) const {
  const std::lock_guard lock(mutex_);
  if (std::find(faults_.begin(), faults_.end(), reason) == faults_.end()) faults_.push_back(reason);
}

}  // namespace msbvh
