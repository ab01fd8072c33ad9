#include "bench/ablation_texture.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <unistd.h>

#include "core/base/error.h"

namespace msbvh::bench {
namespace {

constexpr std::uint32_t kSide = 256;

class Picture {
 public:
  Picture() : path_(std::filesystem::temp_directory_path() / name()) {
    std::ofstream file(path_, std::ios::binary);
    file << "P6\n" << kSide << ' ' << kSide << "\n255\n";
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      const std::uint32_t scattered = (i + 1) * 2654435761u;
      file.put(static_cast<char>(64 + (scattered >> 25)));
      file.put(static_cast<char>(64 + (i % kSide) / 2));
      file.put(static_cast<char>(64 + (i / kSide) / 2));
    }
    if (!file.flush()) throw Error("'" + path_.string() + "': cannot be written");
    text_ = path_.string();
  }
  ~Picture() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  const std::string& path() const { return text_; }

 private:
  static std::string name() { return "msbvh_ablation_" + std::to_string(::getpid()) + ".ppm"; }
  const std::filesystem::path path_;
  std::string text_;
};

}  // namespace

const std::string& texture_file() {
  static const Picture picture;
  return picture.path();
}

}  // namespace msbvh::bench
