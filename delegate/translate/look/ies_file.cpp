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

std::size_t lines_in(std::string_view text) {
  std::size_t lines = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool both = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    lines += !both && (text[i] == '\n' || text[i] == '\r');
  }
  return lines;
}

// Numbers one after the other; commas count as spaces.
class Numbers {
 public:
  // `text` is the end of the whole file.
  Numbers(std::string_view file, std::string_view text) : file_(file), text_(text) {}

  // What is wrong with the number that was read last.
  [[noreturn]] void fail(const std::string& found_and_expected) const {
    const std::size_t line = 1 + lines_in(file_.substr(0, std::min(begin_, file_.size())));
    throw Error("line " + std::to_string(line) + ": " + found_and_expected);
  }

  double next(const char* name) {
    const auto is_space = [](char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); };
    while (!text_.empty() && is_space(text_.front())) text_.remove_prefix(1);
    if (!text_.empty() && text_.front() == '+') text_.remove_prefix(1);
    begin_ = file_.size() - text_.size();
    if (text_.empty()) fail(std::string("found the end of the file; expected ") + name);
    double value = 0.0;
    const auto [end, fault] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (fault != std::errc() || !std::isfinite(value)) {
      fail("found \"" +
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
    fail("found " + std::to_string(value) + "; expected " + name + ", " + std::to_string(least) + " to " +
         std::to_string(most));
  }
  std::vector<float> angles(std::size_t count, const char* name, float least, float most) {
    std::vector<float> angles(count);
    for (std::size_t i = 0; i < count; ++i) {
      angles[i] = float(next(name));
      if (angles[i] >= least && angles[i] <= most && (i == 0 || angles[i] > angles[i - 1])) continue;
      fail("found " + std::to_string(angles[i]) + "; expected " + name + " that increase, " +
           std::to_string(int(least)) + " to " + std::to_string(int(most)));
    }
    return angles;
  }

 private:
  std::string_view file_, text_;
  std::size_t begin_ = 0;  // of the number that was read last
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
  Numbers numbers(text, rest.substr(line));
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

void fill(Around& around, const Numbers& numbers) {
  const float first = around.angles.front(), last = around.angles.back();
  if (around.angles.size() == 1) {
    around.angles = {0.0f};
    around.add(360.0f, Row(around.rows[0]));
  } else if (is_close(first, 90.0f) && is_close(last, 270.0f)) {
    around.mirror_at_end();
    around.turn_back();
  } else if (!is_close(first, 0.0f)) {
    numbers.fail("found horizontal angles from " + std::to_string(first) + " to " + std::to_string(last) +
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

namespace {

// Of types A and B: angles from -90 to 90, both about the light's aim.
struct Rectangle {
  std::vector<float> vertical, horizontal;
  std::vector<Row> rows;  // by horizontal angle

  // What begins at 0 is the same on both sides of it.
  void mirror() {
    if (is_close(vertical.front(), 0.0f)) {
      mirror_angles(vertical);
      for (Row& row : rows) mirror_angles(row, 1.0f);
    }
    if (!is_close(horizontal.front(), 0.0f)) return;
    mirror_angles(horizontal);
    const std::vector<Row> given = rows;
    for (std::size_t i = 1; i < given.size(); ++i) rows.insert(rows.begin(), given[i]);
  }
  float at(float v, float h) const {
    if (v < vertical.front() || v > vertical.back() || h < horizontal.front() || h > horizontal.back())
      return 0.0f;
    const Place row = place(horizontal, h), column = place(vertical, v);
    const Row mix = mixed(rows[row.first], rows[row.second], row.w);
    return mix[column.first] * (1.0f - column.w) + mix[column.second] * column.w;
  }

 private:
  struct Place {
    std::size_t first, second;
    float w;
  };

  static void mirror_angles(std::vector<float>& angles, float sign = -1.0f) {
    const std::vector<float> given = angles;
    for (std::size_t i = 1; i < given.size(); ++i) angles.insert(angles.begin(), sign * given[i]);
  }
  static Place place(const std::vector<float>& angles, float angle) {
    if (angles.size() == 1) return {0, 0, 0.0f};
    const auto after = std::size_t(std::ranges::upper_bound(angles, angle) - angles.begin());
    const std::size_t first = std::clamp<std::size_t>(after, 1, angles.size() - 1) - 1;
    return {first, first + 1, (angle - angles[first]) / (angles[first + 1] - angles[first])};
  }
};

// As type C has it, a value each degree. Looking along the aim, horizontal angles count to the right, which
// is +x of the light, and vertical ones up, +y. Of type A the horizontal angle turns about the vertical axis
// and the vertical one leads out of the plane; of type B the other way round (IES LM-75).
void resample(const Rectangle& given, bool type_a, IesProfile& profile) {
  for (int v = 0; v <= 180; ++v) profile.vertical.push_back(float(v));
  for (int h = 0; h <= 360; ++h) profile.horizontal.push_back(float(h));
  for (int around = 0; around <= 360; ++around) {
    for (int off_aim = 0; off_aim <= 180; ++off_aim) {
      const double sine = std::sin(off_aim * kDegree), aim = std::cos(off_aim * kDegree);
      const double right = sine * std::cos(around * kDegree), up = sine * std::sin(around * kDegree);
      const double latitude = std::asin(std::clamp(type_a ? up : right, -1.0, 1.0)) / kDegree;
      const double longitude = std::atan2(type_a ? right : up, aim) / kDegree;
      profile.candela.push_back(type_a ? given.at(float(latitude), float(longitude))
                                       : given.at(float(longitude), float(latitude)));
    }
  }
}

std::vector<Row> candela_rows(Numbers& numbers, std::size_t rows, std::size_t columns, double factor) {
  std::vector<Row> found(rows, Row(columns));
  for (Row& row : found) {
    for (float& candela : row) {
      candela = float(factor * numbers.next("candela values"));
      if (candela >= 0.0f && std::isfinite(candela)) continue;
      numbers.fail("found " + std::to_string(candela) + " candela; expected a finite number of at least 0");
    }
  }
  return found;
}

void expect_from_middle(const std::vector<float>& angles, const char* name, const Numbers& numbers) {
  if (angles.front() < kSameAngle && (angles.size() == 1 || angles.back() > 0.0f)) return;
  numbers.fail(std::string("found ") + name + " from " + std::to_string(angles.front()) + " to " +
               std::to_string(angles.back()) + "; expected from 0, or from below it to above it");
}

}  // namespace

IesProfile parse_ies(std::string_view text) {
  Numbers numbers = behind_tilt(text);
  numbers.next("a number of lamps");
  numbers.next("lumens a lamp");
  double factor = numbers.next("a candela multiplier");
  const std::size_t columns = numbers.count("a number of vertical angles", 2, kMostAngles);
  const std::size_t rows = numbers.count("a number of horizontal angles", 1, kMostAngles);
  const std::size_t type = numbers.count("a photometric type (1: C, 2: B, 3: A)", 1, 3);
  for (const char* name : {"units", "a width", "a length", "a height"}) numbers.next(name);
  factor *= numbers.next("a ballast factor");
  factor *= numbers.next("a ballast-lamp factor");
  numbers.next("input watts");
  IesProfile profile;
  if (type == 1) {
    profile.vertical = numbers.angles(columns, "vertical angles", 0.0f, 180.0f);
    Around around{numbers.angles(rows, "horizontal angles", 0.0f, 360.0f), {}};
    around.rows = candela_rows(numbers, rows, columns, factor);
    fill(around, numbers);
    profile.horizontal = around.angles;
    for (const Row& row : around.rows) profile.candela.insert(profile.candela.end(), row.begin(), row.end());
  } else {
    Rectangle rectangle{numbers.angles(columns, "vertical angles", -90.0f, 90.0f), {}, {}};
    expect_from_middle(rectangle.vertical, "vertical angles", numbers);
    rectangle.horizontal = numbers.angles(rows, "horizontal angles", -90.0f, 90.0f);
    expect_from_middle(rectangle.horizontal, "horizontal angles", numbers);
    rectangle.rows = candela_rows(numbers, rows, columns, factor);
    rectangle.mirror();
    resample(rectangle, type == 3, profile);
  }
  profile.power = float(mean_intensity(profile));
  return profile;
}

}  // namespace msbvh::translate
