#include "delegate/translate/render/render_vars.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>

namespace msbvh::translate {
namespace {

constexpr std::string_view kColorNames[] = {"color", "Ci", "C", "RGBA", "rgba", "beauty"};
constexpr std::string_view kBeautyExpressions[] = {"C.*[LO]",    "C.*[<L.>O]",    "C.*[<.>O]",
                                                   "C[DS]*[LO]", "C[DS]*[<L.>O]", "C[DS]*[<.>O]"};

struct OtherName {
  std::string_view name;
  Aov aov;
};
constexpr OtherName kOtherNames[] = {
    {"z", Aov::kCameraDepth}, {"Z", Aov::kCameraDepth}, {"N", Aov::kNormal}, {"Nn", Aov::kNormal}};

struct DataType {
  std::string_view name;
  ChannelFormat format;
  std::uint32_t channels;
};
constexpr auto kHalf = ChannelFormat::kHalf;
constexpr auto kFloat = ChannelFormat::kFloat;
// What numbers and colours are, among USD's attribute types.
constexpr DataType kDataTypes[] = {
    {"half", kHalf, 1},      {"half2", kHalf, 2},    {"half3", kHalf, 3},     {"half4", kHalf, 4},
    {"color3h", kHalf, 3},   {"color4h", kHalf, 4},  {"vector3h", kHalf, 3},  {"normal3h", kHalf, 3},
    {"point3h", kHalf, 3},   {"float", kFloat, 1},   {"float2", kFloat, 2},   {"float3", kFloat, 3},
    {"float4", kFloat, 4},   {"color3f", kFloat, 3}, {"color4f", kFloat, 4},  {"vector3f", kFloat, 3},
    {"normal3f", kFloat, 3}, {"point3f", kFloat, 3}, {"double", kFloat, 1},   {"double3", kFloat, 3},
    {"color3d", kFloat, 3},  {"color4d", kFloat, 4}, {"vector3d", kFloat, 3}, {"normal3d", kFloat, 3},
    {"int", kFloat, 1},      {"uint", kFloat, 1},    {"int64", kFloat, 1}};

std::string source_names() {
  std::string names = "color, Ci, RGBA, z, N";
  for (std::size_t i = 0; i < kAovCount; ++i) names.append(", ").append(form_of(Aov(i)).name);
  return names;
}

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string without_blanks(const std::string& text) {
  std::string kept;
  std::copy_if(text.begin(), text.end(), std::back_inserter(kept), [](char c) { return c != ' '; });
  return kept;
}

// An expression without what RenderMan and others write before it.
std::string bare_expression(const std::string& text) {
  std::string bare = without_blanks(text);
  for (const std::string_view prefix : {std::string_view("color"), std::string_view("lpe:")}) {
    if (bare.starts_with(prefix)) bare.erase(0, prefix.size());
  }
  return bare;
}

std::string last_element(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// Whether it can be written; then `var.aov` says what.
bool find_source(const RenderVarInput& input, RenderVarSpec& var, PrimLog& log) {
  const std::string type = input.source_type.value_or("raw");
  std::string name = input.source_name.value_or("");
  if (name.empty()) name = var.name;
  if (type == "lpe") {
    if (is_among(kBeautyExpressions, bare_expression(name))) return true;
    return log.reject("sourceName", message("found the light path expression '", name,
                                            "', expected C.*[LO], all light; no other is written yet"));
  }
  if (type == "primvar") {
    return log.reject("sourceType", message("found primvar (", name, "), which is not written yet"));
  }
  if (type != "raw" && type != "intrinsic") {
    return log.reject("sourceType", message("found '", type, "', expected raw, primvar, lpe or intrinsic"));
  }
  if (is_among(kColorNames, name)) return true;
  var.aov = aov_named(name);
  for (const OtherName& other : kOtherNames) {
    if (name == other.name) var.aov = other.aov;
  }
  return var.aov || log.reject("sourceName", message("found '", name, "', expected ", source_names()));
}

// By an authored dataType alone: the schema's fallback, color3f, is there for any var.
void find_format(const RenderVarInput& input, RenderVarSpec& var, PrimLog& log) {
  if (!input.data_type) return;
  const auto* known = std::ranges::find(kDataTypes, *input.data_type, &DataType::name);
  if (known == std::end(kDataTypes)) {
    log.warn("dataType", message("found '", *input.data_type,
                                 "', expected a number or a colour, such as color3f, half or int; ignored"));
    return;
  }
  const std::uint32_t channels = var.aov ? form_of(*var.aov).numbers : 4;
  const bool fits = var.aov ? known->channels == channels : known->channels >= 3;
  if (!fits) {
    log.warn("dataType",
             message("found ", known->name, ", expected ", channels == 4 ? "3 or 4" : message(channels),
                     " numbers a pixel, as there are of it; they are written"));
  }
  var.format = known->format;
  const bool exact = var.aov && (form_of(*var.aov).is_id || form_of(*var.aov).merge == AovMerge::kCoverage);
  if (exact && known->format == kHalf) {
    log.warn("dataType", message("found ", known->name, ", which cannot tell ids apart; written as float"));
    var.format = kFloat;
  }
}

// The names of channels that a file has.
class Channels {
 public:
  // The first of a var's names that is taken; empty: none was, and all are now.
  std::string take(const RenderVarSpec& var) {
    const std::vector<std::string> names = channel_names(var);
    if (!var.aov) {
      const bool again = has_color_;
      has_color_ = true;
      return again ? names.front() : std::string();
    }
    for (const std::string& name : names) {
      if (taken_.contains(name)) return name;
    }
    taken_.insert(names.begin(), names.end());
    return {};
  }

 private:
  std::set<std::string> taken_{"R", "G", "B",
                               "A"};  // there is colour in each, whether a var asks for it or not
  bool has_color_ = false;
};

}  // namespace

std::vector<std::string> channel_names(const RenderVarSpec& var) {
  if (!var.aov) return {"R", "G", "B", "A"};
  return msbvh::channel_names(*var.aov, var.name);
}

std::vector<RenderVarSpec> render_vars(const std::vector<RenderVarInput>& ordered,
                                       std::vector<Diagnostic>& diagnostics) {
  std::vector<RenderVarSpec> found;
  Channels channels;
  for (const RenderVarInput& input : ordered) {
    PrimLog log = PrimLog(diagnostics, input.path).of_optional_part();
    RenderVarSpec var{input.path, last_element(input.path), {}, {}};
    if (!find_source(input, var, log)) continue;
    if (const std::string name = channels.take(var); !name.empty()) {
      log.reject(
          "", message("found channel ", name, " twice in the product, expected other names of render vars"));
      continue;
    }
    find_format(input, var, log);
    found.push_back(std::move(var));
  }
  return found;
}

}  // namespace msbvh::translate
