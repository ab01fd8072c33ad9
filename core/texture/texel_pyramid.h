// A texture file as OpenImageIO's cache sees it: tiles of texels in the rendering space, at every level
// of a pyramid. Its own ways of doing so do not serve: it converts colours in the file's precision, 8 bits
// too; it makes levels from texels that were not converted; and for that it passes its memory limit.
#pragma once

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/texture/image_texture.h"
#include "core/texture/texel_memory.h"

namespace msbvh {

// Shared by all textures of a TextureCache.
struct TexelStore {
  explicit TexelStore(std::uint64_t limit_bytes);
  // Of all that is held; called where it grows.
  void note_memory();
  std::uint64_t memory_bytes() const;
  // One thread at a time frees tiles; others would pass the limit meanwhile.
  void wait_for_memory() const;

  TexelMemory memory;
  std::shared_ptr<OIIO::ImageCache> cache;
  std::shared_ptr<OIIO::TextureSystem> system;
  std::atomic<std::uint64_t> peak_bytes{0};
};

// One file as one colour space has it.
class TexelSource {
 public:
  // Opens nothing yet. `name`: of its own in the cache.
  TexelSource(TexelStore& store, std::string name, TextureFile file, std::string color_space,
              std::string rendering_space);

  // Once; false where it cannot be read, and faults() say why.
  bool open() const;
  const TextureFile& file() const { return file_; }
  std::vector<std::string> faults() const;
  void add_fault(const std::string& reason) const;

  // Of what is open:
  OIIO::TextureSystem::TextureHandle* handle() const { return handle_; }
  int channels() const { return spec_.nchannels; }
  const OIIO::ImageSpec& spec() const { return spec_; }
  // What the file says; black where it says nothing.
  TextureWrap wrap_s() const { return wrap_s_; }
  TextureWrap wrap_t() const { return wrap_t_; }

 private:
  friend class TexelPyramid;

  TexelStore& store_;
  std::string name_;
  TextureFile file_;
  std::string color_space_, rendering_space_;
  mutable std::once_flag once_;
  mutable OIIO::TextureSystem::TextureHandle* handle_ = nullptr;
  mutable OIIO::ImageSpec spec_;
  mutable TextureWrap wrap_s_ = TextureWrap::kBlack, wrap_t_ = TextureWrap::kBlack;
  mutable std::mutex mutex_;  // guards the two below
  mutable std::vector<std::string> faults_;
  mutable std::vector<OIIO::ImageCache::Perthread*> idle_threads_;
};

}  // namespace msbvh
