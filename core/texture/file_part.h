// A part of a file that OpenImageIO reads as if it were one, such as a picture in a usdz package.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

namespace msbvh {

class FilePart final : public OIIO::Filesystem::IOProxy {
 public:
  // opened() is false where there is no such file.
  FilePart(const std::string& path, std::uint64_t offset, std::uint64_t bytes)
      : IOProxy(path, Read), offset_(offset), bytes_(bytes), file_(std::fopen(path.c_str(), "rb")) {
    if (file_ == nullptr) m_mode = Closed;
  }
  ~FilePart() override {
    if (file_ != nullptr) std::fclose(file_);
  }
  FilePart(const FilePart&) = delete;
  FilePart& operator=(const FilePart&) = delete;

  const char* proxytype() const override { return "part of a file"; }
  std::size_t read(void* buffer, std::size_t size) override {
    const std::size_t done = pread(buffer, size, m_pos);
    m_pos += static_cast<std::int64_t>(done);
    return done;
  }
  std::size_t pread(void* buffer, std::size_t size, std::int64_t at) override {
    if (at < 0 || static_cast<std::uint64_t>(at) >= bytes_) return 0;
    size = static_cast<std::size_t>(std::min<std::uint64_t>(size, bytes_ - static_cast<std::uint64_t>(at)));
    const std::lock_guard lock(mutex_);
    if (fseeko(file_, static_cast<off_t>(offset_) + at, SEEK_SET) != 0) return 0;
    return std::fread(buffer, 1, size, file_);
  }
  std::size_t size() const override { return bytes_; }

  // OpenImageIO's name of the format that it begins like; empty: of none that packages hold. Neither the
  // package's own name says it, nor do all of the library's readers try one that has no name.
  std::string format() {
    struct Beginning {
      const char* format;
      std::size_t at;
      std::string_view bytes;
    };
    static constexpr Beginning kBeginnings[] = {{"png", 0, "\x89PNG"},
                                                {"jpeg", 0, "\xff\xd8\xff"},
                                                {"openexr", 0, "\x76\x2f\x31\x01"},
                                                {"heif", 4, "ftyp"},
                                                {"hdr", 0, "#?"},
                                                {"tiff", 0, "II"},
                                                {"tiff", 0, "MM"},
                                                {"webp", 8, "WEBP"},
                                                {"bmp", 0, "BM"}};
    char first[16] = {};
    pread(first, sizeof first, 0);
    for (const Beginning& each : kBeginnings)
      if (std::string_view(first + each.at, each.bytes.size()) == each.bytes) return each.format;
    return "";
  }

 private:
  std::uint64_t offset_, bytes_;
  std::FILE* file_;
  std::mutex mutex_;
};

}  // namespace msbvh
