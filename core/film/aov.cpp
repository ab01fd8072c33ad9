#include "core/film/aov.h"

#include <algorithm>

namespace msbvh {

namespace {

// Layers of two names each, as Cryptomatte numbers them.
std::vector<std::string> crypto_channels(const std::string& layer) {
  std::vector<std::string> names;
  for (std::uint32_t rank = 0; rank < kCryptoRanks; rank += 2) {
    for (const char letter : {'R', 'G', 'B', 'A'})
      names.push_back(layer + "0" + std::to_string(rank / 2) + "." + letter);
  }
  return names;
}

}  // namespace

std::vector<std::string> channel_names(Aov aov, const std::string& layer) {
  const std::string_view letters = form_of(aov).channels;
  if (letters.empty()) return {layer};
  if (form_of(aov).merge == AovMerge::kCoverage) return crypto_channels(layer);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    names.push_back(layer + "." + letters[i]);
    if (std::ranges::count(letters, letters[i]) < 2) continue;
    names.back() += std::to_string(std::ranges::count(letters.substr(0, i), letters[i]));
  }
  return names;
}

}  // namespace msbvh
