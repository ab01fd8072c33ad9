#include "delegate/translate/look/scalar_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/lerp.h"

namespace msbvh::translate {
namespace {

// Between how many of a row of `from` values each of a row of half as many lies: the shares of those that it
// covers, which sum to 1.
struct Cover {
  std::uint32_t first;
  std::array<double, 3> shares;
};
Cover cover_of(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
  const double begin = double(i) * from / to, end = double(i + 1) * from / to;
  Cover cover{std::uint32_t(begin), {}};
  for (std::uint32_t k = 0; k < cover.shares.size(); ++k) {
    const double left = std::max(begin, double(cover.first + k));
    const double right = std::min(end, double(cover.first + k + 1));
    cover.shares[k] = std::max(0.0, right - left) / (end - begin);
  }
  return cover;
}

// Texels next to a coordinate in [0, 1] x texels, and the weight of the second. What a mode has beside the
// image's edge: the other end where it repeats, else the edge itself.
struct Taps {
  std::int64_t first, second;
  double w;
};
Taps taps_at(double coordinate, std::uint32_t count, Wrap wrap) {
  const double place = coordinate * count - 0.5, floor = std::floor(place);
  const auto n = std::int64_t(count);
  const auto inside = [&](std::int64_t i) {
    return wrap == Wrap::kRepeat ? (i + n) % n : std::clamp<std::int64_t>(i, 0, n - 1);
  };
  const auto first = std::int64_t(floor);
  return {inside(first), inside(first + 1), place - floor};
}

// Into [0, 1]; none: black.
std::optional<double> wrapped(double coordinate, Wrap wrap) {
  switch (wrap) {
    case Wrap::kBlack:
      if (!(coordinate >= 0.0 && coordinate <= 1.0)) return std::nullopt;
      return coordinate;
    case Wrap::kClamp:
      return std::clamp(coordinate, 0.0, 1.0);
    case Wrap::kRepeat:
      return coordinate - std::floor(coordinate);
    case Wrap::kMirror:
      break;
  }
  const double twice = coordinate - 2.0 * std::floor(0.5 * coordinate);  // in [0, 2]
  return twice > 1.0 ? 2.0 - twice : twice;
}

}  // namespace

std::optional<Wrap> wrap_from(std::string_view token) {
  if (token == "black") return Wrap::kBlack;
  if (token == "clamp") return Wrap::kClamp;
  if (token == "repeat") return Wrap::kRepeat;
  if (token == "mirror") return Wrap::kMirror;
  return std::nullopt;
}

ScalarTexture::ScalarTexture(ScalarImage image, Wrap wrap_s, Wrap wrap_t) : wrap_s_(wrap_s), wrap_t_(wrap_t) {
  levels_.push_back({image.width, image.height, std::move(image.values)});
  const auto [least, largest] = std::ranges::minmax(levels_.front().values);
  const bool black = wrap_s == Wrap::kBlack || wrap_t == Wrap::kBlack;
  least_ = black ? std::min(0.0f, least) : least;
  largest_ = black ? std::max(0.0f, largest) : largest;
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(halved(levels_.back()));
}

ScalarTexture::ScalarTexture(std::vector<ScalarTile> tiles) {
  for (ScalarTile& tile : tiles) {
    tile_places_.push_back({tile.s, tile.t});
    tiles_.emplace_back(std::move(tile.image), Wrap::kClamp, Wrap::kClamp);
    least_ = std::min(least_, tiles_.back().least());
    largest_ = std::max(largest_, tiles_.back().largest());
  }
}

const ScalarTexture* ScalarTexture::tile(int s, int t) const {
  const auto found = std::ranges::find(tile_places_, std::array{s, t});
  return found == tile_places_.end() ? nullptr : &tiles_[std::size_t(found - tile_places_.begin())];
}

// A tile's edges belong to it, where no other begins.
double ScalarTexture::in_tiles(double s, double t, double size_s, double size_t) const {
  constexpr double kFarthest = 1000.0;  // there are ten tiles a row, and ten rows
  if (!(std::abs(s) < kFarthest && std::abs(t) < kFarthest)) return 0.0;
  const double left = std::floor(s), lower = std::floor(t);
  for (const double u : {left, s == left ? left - 1.0 : left}) {
    for (const double v : {lower, t == lower ? lower - 1.0 : lower}) {
      if (const ScalarTexture* found = tile(int(u), int(v))) return found->at(s - u, t - v, size_s, size_t);
    }
  }
  return 0.0;
}

// Each value is the mean over what it covers, also of sides that are odd.
ScalarTexture::Level ScalarTexture::halved(const Level& level) {
  Level half{std::max(1u, level.width / 2), std::max(1u, level.height / 2), {}};
  half.values.reserve(std::size_t(half.width) * half.height);
  std::vector<Cover> columns;
  for (std::uint32_t c = 0; c < half.width; ++c) columns.push_back(cover_of(c, level.width, half.width));
  for (std::uint32_t r = 0; r < half.height; ++r) {
    const Cover row = cover_of(r, level.height, half.height);
    for (const Cover& column : columns) {
      double sum = 0.0;
      for (std::uint32_t i = 0; i < 3; ++i) {
        if (row.shares[i] == 0.0) continue;
        const float* values = level.values.data() + std::size_t(row.first + i) * level.width + column.first;
        for (std::uint32_t k = 0; k < 3; ++k) {
          if (column.shares[k] != 0.0) sum += row.shares[i] * column.shares[k] * double(values[k]);
        }
      }
      half.values.push_back(float(sum));
    }
  }
  return half;
}

double ScalarTexture::bilinear(const Level& level, double s, double t) const {
  const Taps across = taps_at(s, level.width, wrap_s_), down = taps_at(1.0 - t, level.height, wrap_t_);
  const auto row = [&](std::int64_t r) {
    const float* values = level.values.data() + std::size_t(r) * level.width;
    return lerp(double(values[across.first]), double(values[across.second]), across.w);
  };
  return lerp(row(down.first), row(down.second), down.w);
}

double ScalarTexture::at(double s, double t, double size_s, double size_t) const {
  if (!std::isfinite(s) || !std::isfinite(t)) return 0.0;
  if (!tiles_.empty()) return in_tiles(s, t, size_s, size_t);
  const std::optional<double> u = wrapped(s, wrap_s_), v = wrapped(t, wrap_t_);
  if (!u || !v) return 0.0;
  const Level& image = levels_.front();
  const double texels = std::max(size_s * image.width, size_t * image.height);
  if (!(texels > 1.0)) return bilinear(image, *u, *v);
  const double level = std::log2(texels), last = double(levels_.size() - 1);
  if (!(level < last)) return bilinear(levels_.back(), *u, *v);
  const auto fine = std::size_t(level);
  return lerp(bilinear(levels_[fine], *u, *v), bilinear(levels_[fine + 1], *u, *v), level - double(fine));
}

}  // namespace msbvh::translate
