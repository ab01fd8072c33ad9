#include "core/film/name_hash.h"

#include <bit>
#include <cstddef>

namespace msbvh {
namespace {

std::uint32_t mixed(std::uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; }

std::uint32_t byte(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

}  // namespace

std::uint32_t murmur3_32(std::string_view text) {
  std::uint32_t hash = 0;
  const std::size_t whole = text.size() & ~std::size_t(3);
  for (std::size_t i = 0; i < whole; i += 4) {
    const std::uint32_t block =
        byte(text, i) | byte(text, i + 1) << 8 | byte(text, i + 2) << 16 | byte(text, i + 3) << 24;
    hash = std::rotl(hash ^ mixed(block), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t i = text.size(); i-- > whole;) rest = rest << 8 | byte(text, i);
  if (whole < text.size()) hash ^= mixed(rest);
  hash ^= static_cast<std::uint32_t>(text.size());
  hash = (hash ^ (hash >> 16)) * 0x85ebca6bu;
  hash = (hash ^ (hash >> 13)) * 0xc2b2ae35u;
  return hash ^ (hash >> 16);
}

}  // namespace msbvh
