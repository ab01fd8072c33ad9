#include "delegate/translate/look/ies_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/error.h"

namespace msbvh::translate {
namespace {

constexpr std::size_t kMostAngles = 4096;  // of either kind; the finest files have a tenth of that
constexpr float kSameAngle = 1e-3f;        // degrees
constexpr float kMoreThanHalf = 95.7f;  // degrees: UsdLux's reference takes pi / 2 + 0.1 for a whole sphere
constexpr double kDegree = std::numbers::pi / 180.0;

bool is_close(float a, float b) { return std::abs(a - b) < kSameAngle; }

// Numbers one after the other; commas count as spaces.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}

  double next(const char* name) {
    const auto is_space = [](char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); };
    while (!text_.empty() && is_space(text_.front())) text_.remove_prefix(1);
    if (!text_.empty() && text_.front() == '+') text_.remove_prefix(1);
    if (text_.empty()) throw Error(std::string("found the end of the file; expected ") + name);
    double value = 0.0;
    const auto [end, fault] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (fault != std::errc() || !std::isfinite(value)) {
      throw Error("found \"" +
                  std::string(text_.substr(0, std::min<std::size_t>(text_.find_first_of(" ,\t\r\n"), 16))) +
                  "\"; expected " + name + ", a finite number");
    }
    text_.remove_prefix(std::size_t(end - text_.data()));
    return value;
  }
  std::size_t count(const char* name, std::size_t least, std::size_t most) {
    const double value = next(name);
    if (value >= double(least) && value <= double(most) && value == std::floor(value))
      return std::size_t(value);
    throw Error("found " + std::to_string(value) + "; expected " + name + ", " + std::to_string(least) +
                " to " + std::to_string(most));
  }
  std::vector<float> angles(std::size_t count, const char* name, float most) {
    std::vector<float> angles(count);
    for (float& angle : angles) angle = float(next(name));
    for (std::size_t i = 0; i < count; ++i) {
      if (angles[i] >= 0.0f && angles[i] <= most && (i == 0 || angles[i] > angles[i - 1])) continue;
      throw Error("found " + std::to_string(angles[i]) + "; expected " + name + " that increase, 0 to " +
                  std::to_string(int(most)));
    }
    return angles;
  }

 private:
  std::string_view text_;
};

// Behind the labels, and behind the line or block that says how the lamp is tilted.
Numbers behind_tilt(std::string_view text) {
  const std::string_view key = "TILT=";
  std::size_t at = text.find(key);
  while (at != std::string_view::npos && at > 0 && text[at - 1] != '\n' && text[at - 1] != '\r')
    at = text.find(key, at + 1);
  if (at == std::string_view::npos) throw Error("found no line TILT=; expected an IES file");
  const std::string_view rest = text.substr(at + key.size());
  const std::size_t line = std::min(rest.find_first_of("\r\n"), rest.size());
  Numbers numbers(rest.substr(line));
  if (!rest.starts_with("INCLUDE")) return numbers;
  numbers.next("the lamp's place in the luminaire");
  const std::size_t tilts = numbers.count("a number of tilt angles", 0, kMostAngles);
  for (std::size_t i = 0; i < 2 * tilts; ++i) numbers.next("tilt angles and factors");
  return numbers;
}

using Row = std::vector<float>;  // candela by vertical angle

Row mixed(const Row& a, const Row& b, float w) {
  Row row(a.size());
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = a[i] * (1.0f - w) + b[i] * w;
  return row;
}

// All around, from what the symmetry leaves out.
struct Around {
  std::vector<float> angles;
  std::vector<Row> rows;

  void add(float angle, const Row& row) {
    angles.push_back(angle);
    rows.push_back(row);
  }
  // At what follows the last angle's mirror image.
  void mirror_at_end() {
    const float end = angles.back();
    for (std::size_t i = angles.size() - 1; i-- > 0;) add(2.0f * end - angles[i], Row(rows[i]));
  }
  // Of 90 to 450 degrees, 0 to 360.
  void turn_back() {
    const auto after = std::size_t(std::ranges::upper_bound(angles, 360.0f - kSameAngle) - angles.begin());
    Around turned;
    const float w = (360.0f - angles[after - 1]) / (angles[after] - angles[after - 1]);
    const Row at_zero = mixed(rows[after - 1], rows[after], w);
    turned.add(0.0f, at_zero);
    for (std::size_t i = after; i < angles.size(); ++i) {
      if (angles[i] - 360.0f > kSameAngle) turned.add(angles[i] - 360.0f, rows[i]);
    }
    for (std::size_t i = 1; i < after; ++i) turned.add(angles[i], rows[i]);  // 90 is there already
    turned.add(360.0f, at_zero);
    *this = std::move(turned);
  }
};

void fill(Around& around) {
  const float first = around.angles.front(), last = around.angles.back();
  if (around.angles.size() == 1) {
    around.angles = {0.0f};
    around.add(360.0f, Row(around.rows[0]));
  } else if (is_close(first, 90.0f) && is_close(last, 270.0f)) {
    around.mirror_at_end();
    around.turn_back();
  } else if (!is_close(first, 0.0f)) {
    throw Error("found horizontal angles from " + std::to_string(first) + " to " + std::to_string(last) +
                "; expected from 0, or 90 to 270");
  } else if (is_close(last, 90.0f) || is_close(last, 180.0f)) {
    around.mirror_at_end();
    if (is_close(around.angles.back(), 180.0f)) around.mirror_at_end();
  } else if (!is_close(last, 360.0f)) {
    around.add(360.0f, Row(around.rows[0]));  // some files leave it out
  }
}

double mean_intensity(const IesProfile& profile) {
  const std::vector<float>&v = profile.vertical, &h = profile.horizontal;
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < h.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const float* a = &profile.candela[i * v.size() + j];
      const float* b = a + v.size();
      const double patch =
          (h[i + 1] - h[i]) * kDegree * (std::cos(v[j] * kDegree) - std::cos(v[j + 1] * kDegree));
      sum += patch * 0.25 * (double(a[0]) + a[1] + b[0] + b[1]);
    }
  }
  const bool whole = v.back() - v.front() > kMoreThanHalf;
  return sum / (std::numbers::pi * (whole ? 4.0 : 2.0));
}

}  // namespace

IesProfile parse_ies(std::string_view text) {
  Numbers numbers = behind_tilt(text);
  numbers.next("a number of lamps");
  numbers.next("lumens a lamp");
  double factor = numbers.next("a candela multiplier");
  const std::size_t columns = numbers.count("a number of vertical angles", 2, kMostAngles);
  const std::size_t rows = numbers.count("a number of horizontal angles", 1, kMostAngles);
  const double type = numbers.next("a photometric type");
  if (type != 1.0)
    throw Error("found photometric type " + std::to_string(int(type)) + "; expected 1, type C");
  for (const char* name : {"units", "a width", "a length", "a height"}) numbers.next(name);
  factor *= numbers.next("a ballast factor");
  factor *= numbers.next("a ballast-lamp factor");
  numbers.next("input watts");
  IesProfile profile;
  profile.vertical = numbers.angles(columns, "vertical angles", 180.0f);
  Around around{numbers.angles(rows, "horizontal angles", 360.0f), {}};
  for (std::size_t i = 0; i < rows; ++i) {
    Row& row = around.rows.emplace_back(columns);
    for (float& candela : row) {
      candela = float(factor * numbers.next("candela values"));
      if (!(candela >= 0.0f && std::isfinite(candela))) {
        throw Error("found " + std::to_string(candela) + " candela; expected a finite number of at least 0");
      }
    }
  }
  fill(around);
  profile.horizontal = around.angles;
  for (const Row& row : around.rows) profile.candela.insert(profile.candela.end(), row.begin(), row.end());
  profile.power = float(mean_intensity(profile));
  return profile;
}

}  // namespace msbvh::translate
