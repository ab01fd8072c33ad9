#include "delegate/translate/render/own_settings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "core/build/settings.h"
#include "core/film/noise_goal.h"
#include "core/motion/track.h"
#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

constexpr std::string_view kNamespace = "msbvh:";
constexpr std::int64_t kMostSamples = std::int64_t(1) << 20;
constexpr std::int64_t kMostBounces = 64;
constexpr std::int64_t kLargestSeed = (std::int64_t(1) << 32) - 1;
constexpr double kLeastTolerance = 1e-6;

struct WholeNumber {
  std::string_view name;
  std::optional<std::int64_t> OwnSettings::*member;
  std::int64_t least, most;
  bool power_of_two = false;  // or 0
};
constexpr WholeNumber kWholeNumbers[] = {
    {"samplesPerPixel", &OwnSettings::samples, 1, kMostSamples},
    {"seed", &OwnSettings::seed, 0, kLargestSeed},
    {"maxBounces", &OwnSettings::max_bounces, 0, kMostBounces},
    {"segments", &OwnSettings::segments, 0, std::int64_t(kMaxSegments), true},
};

struct RealNumber {
  std::string_view name;
  std::optional<double> OwnSettings::*member;
  double least, most = std::numeric_limits<double>::max();
};
constexpr RealNumber kRealNumbers[] = {{"motionTolerance", &OwnSettings::motion_tolerance, kLeastTolerance},
                                       {"edgeLength", &OwnSettings::edge_length, 0.0},
                                       {"noise", &OwnSettings::noise, 0.0, kLargestNoiseTarget}};

struct Flag {
  std::string_view name;
  std::optional<bool> OwnSettings::*member;
};
constexpr Flag kFlags[] = {{"refraction", &OwnSettings::refraction}};

struct Choice {
  std::string_view name;
  std::optional<std::string> OwnSettings::*member;
  std::vector<std::string> choices;
};
std::vector<Choice> choices() {
  std::vector<Choice> all{
      {"interpolation", &OwnSettings::interpolation, {"auto", "linear", "quadratic", "cubic"}},
      {"builder", &OwnSettings::builder, {}},
      {"layout", &OwnSettings::layout, {}}};
  for (const BuilderName& known : kBuilders) all[1].choices.emplace_back(known.name);
  for (const TreeLayoutName& known : kTreeLayouts) all[2].choices.emplace_back(known.name);
  return all;
}

std::string shown(const NamedSetting& setting) {
  return std::visit(
      [&](const auto& value) -> std::string {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::monostate>)
          return setting.type.empty() ? "no value" : setting.type;
        if constexpr (std::is_same_v<T, bool>) return value ? "true" : "false";
        if constexpr (std::is_same_v<T, std::int64_t>) return std::to_string(value);
        if constexpr (std::is_same_v<T, double>) return text(value);
        if constexpr (std::is_same_v<T, std::string>) return "'" + value + "'";
      },
      setting.value);
}

// A number, whatever its type is; none for anything else.
std::optional<double> number(const SettingValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return double(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return std::nullopt;
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

// Each returns what is expected where the value is not that; empty where it is, and has been taken.
std::string take(const WholeNumber& known, const SettingValue& value, OwnSettings& into) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  const bool fits = whole && *whole >= known.least && *whole <= known.most &&
                    (!known.power_of_two || (*whole & (*whole - 1)) == 0);
  if (fits) {
    into.*known.member = *whole;
    return {};
  }
  if (known.power_of_two) return message("0 or a power of two up to ", known.most);
  return message("an integer from ", known.least, " to ", known.most);
}

std::string take(const RealNumber& known, const SettingValue& value, OwnSettings& into) {
  const std::optional<double> found = number(value);
  if (!found || !std::isfinite(*found) || *found < known.least || *found > known.most) {
    const bool open = known.most == std::numeric_limits<double>::max();
    return open ? message("a finite number of at least ", known.least)
                : message("a number from ", known.least, " to ", known.most);
  }
  into.*known.member = *found;
  return {};
}

std::string take(const Flag& known, const SettingValue& value, OwnSettings& into) {
  const auto* flag = std::get_if<bool>(&value);
  if (!flag) return "a bool";
  into.*known.member = *flag;
  return {};
}

std::string take(const Choice& known, const SettingValue& value, OwnSettings& into) {
  const auto* name = std::get_if<std::string>(&value);
  if (!name || std::ranges::find(known.choices, *name) == known.choices.end())
    return message("one of ", joined(known.choices));
  into.*known.member = *name;
  return {};
}

// Looks a name up in a table; true where it is there, and `expected` says what take() says.
template <typename Table>
bool taken_by(const Table& table, std::string_view name, const SettingValue& value, OwnSettings& into,
              std::string& expected) {
  for (const auto& known : table) {
    if (known.name != name) continue;
    expected = take(known, value, into);
    return true;
  }
  return false;
}

}  // namespace

OwnSettings own_settings(const std::vector<NamedSetting>& settings, const std::string& path,
                         std::vector<Diagnostic>& diagnostics) {
  OwnSettings own;
  PrimLog log(diagnostics, path);
  const std::vector<Choice> by_name = choices();
  for (const NamedSetting& setting : settings) {
    if (!setting.name.starts_with(kNamespace)) continue;
    const std::string_view name = std::string_view(setting.name).substr(kNamespace.size());
    std::string expected;
    const bool known = taken_by(kWholeNumbers, name, setting.value, own, expected) ||
                       taken_by(kRealNumbers, name, setting.value, own, expected) ||
                       taken_by(kFlags, name, setting.value, own, expected) ||
                       taken_by(by_name, name, setting.value, own, expected);
    if (!known) {
      log.warn(setting.name, "unknown; ignored");
    } else if (!expected.empty()) {
      log.warn(setting.name, message("found ", shown(setting), ", expected ", expected, "; ignored"));
    }
  }
  return own;
}

}  // namespace msbvh::translate
