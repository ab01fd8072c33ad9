#include "delegate/hydra/settings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <pxr/imaging/hd/tokens.h>

#include "core/motion/track.h"

namespace msbvh::hydra {
namespace {

using translate::message;
using translate::Severity;

struct Setting {
  const char* name;
  TfToken key;
  VtValue standard;
  // False for a value that makes no sense.
  std::function<bool(Settings&, const VtValue&)> apply;
  const char* expected;
};

bool is_power_of_two_or_zero(int value) { return value >= 0 && (value & (value - 1)) == 0; }

template <typename Member>
std::function<bool(Settings&, const VtValue&)> count(Member member, int least) {
  return [member, least](Settings& settings, const VtValue& value) {
    const VtValue number = VtValue::Cast<int>(value);
    if (!number.IsHolding<int>() || number.UncheckedGet<int>() < least) return false;
    member(settings) = std::uint32_t(number.UncheckedGet<int>());
    return true;
  };
}

template <typename Member>
std::function<bool(Settings&, const VtValue&)> length(Member member, double least) {
  return [member, least](Settings& settings, const VtValue& value) {
    const VtValue number = VtValue::Cast<double>(value);
    if (!number.IsHolding<double>() || !(number.UncheckedGet<double>() >= least)) return false;
    member(settings) = number.UncheckedGet<double>();
    return std::isfinite(number.UncheckedGet<double>());
  };
}

std::string text_of(const VtValue& value) {
  if (value.IsHolding<TfToken>()) return value.UncheckedGet<TfToken>().GetString();
  return value.IsHolding<std::string>() ? value.UncheckedGet<std::string>() : std::string();
}

bool apply_interpolation(Settings& settings, const VtValue& value) {
  const std::string name = text_of(value);
  translate::TrackChoice& choice = settings.translate.choice;
  const std::pair<const char*, std::uint32_t> degrees[] = {{"linear", 1}, {"quadratic", 2}, {"cubic", 3}};
  if (name == "auto") {
    const translate::TrackChoice any;
    choice.min_degree = any.min_degree;
    choice.max_degree = any.max_degree;
    return true;
  }
  for (const auto& [known, degree] : degrees) {
    if (name != known) continue;
    choice.min_degree = choice.max_degree = degree;
    return true;
  }
  return false;
}

bool apply_segments(Settings& settings, const VtValue& value) {
  const VtValue number = VtValue::Cast<int>(value);
  if (!number.IsHolding<int>() || !is_power_of_two_or_zero(number.UncheckedGet<int>()) ||
      std::uint32_t(number.UncheckedGet<int>()) > kMaxSegments)
    return false;
  settings.translate.choice.segments = std::uint32_t(number.UncheckedGet<int>());
  return true;
}

bool apply_builder(Settings& settings, const VtValue& value) {
  for (const BuilderName& known : kBuilders) {
    if (text_of(value) != known.name) continue;
    settings.render.build.builder = known.builder;
    return true;
  }
  return false;
}

bool apply_layout(Settings& settings, const VtValue& value) {
  for (const TreeLayoutName& known : kTreeLayouts) {
    if (text_of(value) != known.name) continue;
    settings.render.build.layout = known.layout;
    return true;
  }
  return false;
}

bool apply_noise(Settings& settings, const VtValue& value) {
  const VtValue number = VtValue::Cast<double>(value);
  if (!number.IsHolding<double>()) return false;
  const double target = number.UncheckedGet<double>();
  if (!(target >= 0.0 && target <= kLargestNoiseTarget)) return false;
  settings.render.noise.target = float(target);
  return true;
}

bool apply_dome_visibility(Settings& settings, const VtValue& value) {
  const VtValue flag = VtValue::Cast<bool>(value);
  if (!flag.IsHolding<bool>()) return false;
  settings.render.show_domes = flag.UncheckedGet<bool>();
  return true;
}

bool apply_refraction(Settings& settings, const VtValue& value) {
  const VtValue flag = VtValue::Cast<bool>(value);
  if (!flag.IsHolding<bool>()) return false;
  settings.render.refraction = flag.UncheckedGet<bool>();
  return true;
}

const std::vector<Setting>& all_settings() {
  const auto& keys = HdRenderSettingsTokens;
  const auto render = [](auto member) { return [member](Settings& s) -> auto& { return s.render.*member; }; };
  const auto translated = [](auto member) {
    return [member](Settings& s) -> auto& { return s.translate.*member; };
  };
  static const RenderSettings standard;
  static const translate::TranslatorSettings standard_translate;
  static const std::vector<Setting> all{
      {"Samples per pixel", keys->convergedSamplesPerPixel, VtValue(int(standard.spp)),
       count(render(&RenderSettings::spp), 1), "an integer of at least 1"},
      {"Noise target (0: off)", TfToken("msbvh:noise"), VtValue(double(standard.noise.target)), apply_noise,
       "a number from 0 to 1"},
      {"Seed", TfToken("msbvh:seed"), VtValue(int(standard.seed)), count(render(&RenderSettings::seed), 0),
       "an integer of at least 0"},
      {"Bounces", TfToken("msbvh:maxBounces"), VtValue(int(standard.max_bounces)),
       count(render(&RenderSettings::max_bounces), 0), "an integer of at least 0"},
      {"Threads (0: all)", keys->threadLimit, VtValue(0), count(render(&RenderSettings::threads), 0),
       "an integer of at least 0"},
      {"Show dome lights", keys->domeLightCameraVisibility, VtValue(true), apply_dome_visibility, "a bool"},
      {"Refraction", TfToken("msbvh:refraction"), VtValue(standard.refraction), apply_refraction, "a bool"},
      {"Motion tolerance in pixels", TfToken("msbvh:motionTolerance"),
       VtValue(standard_translate.motion_tolerance_pixels),
       length(translated(&translate::TranslatorSettings::motion_tolerance_pixels), 1e-6),
       "a number of at least 1e-6"},
      {"Edges of subdivided surfaces in pixels (0: cages)", TfToken("msbvh:edgeLength"),
       VtValue(standard_translate.edge_length_pixels),
       length(translated(&translate::TranslatorSettings::edge_length_pixels), 0.0), "a number of at least 0"},
      {"Interpolation between keys", TfToken("msbvh:interpolation"), VtValue(std::string("auto")),
       apply_interpolation, "auto, linear, quadratic or cubic"},
      {"Motion segments (0: as few as it takes)", TfToken("msbvh:segments"), VtValue(0), apply_segments,
       "0 or a power of two up to 128"},
      {"Builder", TfToken("msbvh:builder"), VtValue(std::string("msbvh")), apply_builder,
       "msbvh, mbvh, swept or timesplit"},
      {"Tree layout", TfToken("msbvh:layout"), VtValue(std::string("full")), apply_layout, "full or compact"},
  };
  return all;
}

}  // namespace

const HdRenderSettingDescriptorList& setting_descriptors() {
  static const HdRenderSettingDescriptorList all = [] {
    HdRenderSettingDescriptorList list;
    for (const Setting& setting : all_settings())
      list.push_back({setting.name, setting.key, setting.standard});
    return list;
  }();
  return all;
}

Settings settings_of(const HdRenderDelegate& delegate, Diagnostics& said) {
  Settings settings;
  for (const Setting& setting : all_settings()) {
    const VtValue value = delegate.GetRenderSetting(setting.key);
    if (value.IsEmpty()) continue;
    Settings changed = settings;
    if (setting.apply(changed, value)) {
      settings = changed;
      continue;
    }
    said.push_back({Severity::kWarning, "render settings", setting.key.GetString(),
                    message("found ", TfStringify(value), ", expected ", setting.expected, "; left out")});
  }
  // What follows is the next edit of the same scene, or the next frame.
  settings.render.build.keep_topology = true;
  return settings;
}

void set_choice(Settings& settings, const TfToken& key, const std::string& name) {
  for (const Setting& setting : all_settings()) {
    if (setting.key == key) setting.apply(settings, VtValue(name));
  }
}

std::vector<VtValue> values_set(const HdRenderDelegate& delegate) {
  std::vector<VtValue> values;
  for (const Setting& setting : all_settings()) values.push_back(delegate.GetRenderSetting(setting.key));
  return values;
}

const TfTokenVector& setting_namespaces() {
  static const TfTokenVector names{TfToken("msbvh")};
  return names;
}

}  // namespace msbvh::hydra
