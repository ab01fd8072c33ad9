#include "delegate/translate/round/round_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "delegate/translate/material_primvars.h"
#include "delegate/translate/primvar_track.h"
#include "delegate/translate/primvars.h"

namespace msbvh::translate {
namespace {

// As usdview draws curves that have none.
constexpr float kDefaultWidth = 1.0f;

float mixed(const std::vector<float>& values, std::span<const Term> terms) {
  double sum = 0.0;
  for (const Term& term : terms) sum += term.weight * double(values[term.index]);
  return float(sum);
}
template <typename Values>
Vec3f mixed(const Values& values, std::span<const Term> terms) {
  if (terms.size() == 1 && terms[0].weight == 1.0) return values[terms[0].index];  // keeps every bit
  Vec3d sum;
  for (const Term& term : terms) sum += Vec3d(values[term.index]) * term.weight;
  return Vec3f(sum);
}

float between(float a, float b, double w) { return float(lerp(double(a), double(b), w)); }
Vec3f between(const Vec3f& a, const Vec3f& b, double w) { return Vec3f(lerp(Vec3d(a), Vec3d(b), w)); }

bool is_bad_width(float width) { return !(width >= 0.0f && width <= kMaxCoordinate); }

double mean_scale(const Affine3d& map) { return (length(map.x) + length(map.y) + length(map.z)) / 3.0; }

// A linear track of even keys at a time of the shutter.
float value_at(const Primvar<float>& track, std::size_t count, std::size_t i, double time01) {
  const SegmentTime at = locate(float(time01), track.segments);
  const float first = track.values[at.key * count + i];
  if (track.segments == 0) return first;
  return lerp(first, track.values[(at.key + 1) * count + i], at.w);
}

template <typename T>
bool check_values(const PrimvarInput<T>& input, std::size_t expected, const std::string& attribute,
                  PrimLog& log) {
  const std::size_t found = input.indices.empty() ? input.values.size() : input.indices.size();
  if (found != expected) {
    return log.reject(attribute,
                      message("found ", found, input.indices.empty() ? " values" : " indices", "; expected ",
                              expected, " for the interpolation ", input.interpolation));
  }
  const auto bad = std::ranges::find_if(
      input.indices, [&](int index) { return index < 0 || std::size_t(index) >= input.values.size(); });
  if (bad == input.indices.end()) return true;
  return log.reject(attribute,
                    message("index ", bad - input.indices.begin(), " is ", *bad, "; expected less than ",
                            input.values.size(), ", the number of values"));
}

template <typename T>
bool check_colors(const PrimvarInput<T>& input, const std::string& attribute, PrimLog& log) {
  const auto bad = std::ranges::find_if_not(input.values, [](const T& value) { return is_color(value); });
  if (bad == input.values.end()) return true;
  return log.reject(attribute,
                    message("value ", bad - input.values.begin(),
                            " is not finite or too large; expected finite numbers of at most 65504 in size"));
}

}  // namespace

std::optional<RoundShape> RoundShape::make(const MeshInput& input, std::size_t points, bool frame_only,
                                           CurveStyle style, std::uint32_t max_segments, PrimLog& log) {
  RoundShape shape(points);
  if (input.round.kind == RoundInput::Kind::kCurves) {
    shape.curves_ = curve_basis(input.round.topology, points, log);
    if (!shape.curves_) return std::nullopt;
    PrimLog optional = log.of_optional_part();
    if (style == CurveStyle::kRibbon)
      shape.normals_ = CurveNormals::make(input, *shape.curves_, frame_only, optional);
    shape.style_ = style == CurveStyle::kTube ? CurveShape::kTube
                   : shape.normals_           ? CurveShape::kOriented
                                              : CurveShape::kRibbon;
  }
  if (shape.vertex_count() == 0 || !shape.read_widths(input, max_segments, log)) return std::nullopt;
  return shape;
}

double RoundShape::reach() const {
  return widths_.values.empty() ? 0.0 : 0.5 * double(*std::ranges::max_element(widths_.values));
}

std::uint32_t RoundShape::needed_segments(const TransformTrack& transform, const TimeLayout& layout,
                                          const ScreenMeasure& measure, const Box3d& box,
                                          const FitSettings& settings) const {
  const std::uint32_t by_normals =
      normals_ ? normals_->segments(transform, layout, settings.max_segments) : 0;
  return std::max({widths_.segments, by_normals, scale_segments(transform, measure, box, settings)});
}

// As many as keep radii, which the transform scales, within the tolerance: linear between keys, and the
// centre's throughout where there is no segment.
std::uint32_t RoundShape::scale_segments(const TransformTrack& transform, const ScreenMeasure& measure,
                                         const Box3d& box, const FitSettings& settings) const {
  constexpr double kBetween[] = {0.0, 0.25, 0.5, 0.75, 1.0};
  if (transform.is_still()) return 0;
  const double reach = this->reach();
  const auto radius = [&](double time01) { return reach * mean_scale(transform.at(time01, time01)); };
  const auto within = [&](std::uint32_t segments) {
    for (std::uint32_t k = 0; k < std::max(1u, segments); ++k) {
      const double a = segments == 0 ? 0.0 : double(k) / segments;
      const double b = segments == 0 ? 1.0 : (k + 1.0) / segments;
      for (const double w : kBetween) {
        const double time01 = lerp(a, b, w);
        const double kept = segments == 0 ? radius(0.5) : lerp(radius(a), radius(b), w);
        const double error = std::abs(kept - radius(time01));
        if (measure.at(time01).in_box(error, box) > settings.tolerance) return false;
      }
    }
    return true;
  };
  for (std::uint32_t segments = 0; segments < settings.max_segments; segments = std::max(1u, 2 * segments)) {
    if (within(segments)) return segments;
  }
  return settings.max_segments;
}

// 0: there is no such interpolation.
std::size_t RoundShape::expected(const std::string& interpolation) const {
  if (interpolation == "constant") return 1;
  if (interpolation == "uniform") return curves_ ? curves_->curves : 1;
  if (interpolation == "vertex") return curves_ ? curves_->authored_vertices : point_count_;
  if (interpolation == "varying" || interpolation == "faceVarying")
    return curves_ ? curves_->authored_varying : point_count_;
  return 0;
}

template <typename T>
void RoundShape::expand(const std::string& interpolation, const std::vector<T>& authored,
                        std::vector<T>& out) const {
  if (authored.size() == 1 && (interpolation == "constant" || !curves_)) {
    out.push_back(authored[0]);
  } else if (!curves_) {
    out.insert(out.end(), authored.begin(), authored.end());
  } else if (interpolation == "uniform") {
    for (const std::uint32_t curve : curves_->span_curves) out.push_back(authored[curve]);
  } else {
    for (std::size_t v = 0; v < vertex_count(); ++v) {
      const CurveBasis::Between& at = curves_->varying[v];
      const bool by_curve = interpolation == "vertex" && !curves_->vertex_as_varying;
      out.push_back(by_curve ? mixed(authored, curves_->terms_of(v))
                             : between(authored[at.from], authored[at.to], at.w));
    }
  }
}

template <typename T>
Primvar<T> RoundShape::expanded(const PrimvarInput<T>& input, const std::string& attribute,
                                std::uint32_t max_segments, PrimLog& log) const {
  if (input.values.empty()) return {};
  const std::size_t expected_count = expected(input.interpolation);
  if (expected_count == 0) {
    log.reject(attribute, message("found the interpolation \"", input.interpolation,
                                  "\"; expected constant, uniform, varying, vertex or faceVarying"));
    return {};
  }
  if (!check_values(input, expected_count, attribute, log)) return {};
  const PrimvarTrack<T> track = fit_primvar(input, max_segments, attribute, log);
  const std::size_t count = input.values.size();
  Primvar<T> result{Interpolation::kVertex, track.segments, {}};
  for (std::uint32_t key = 0; key < key_count(track.segments); ++key) {
    const T* values = track.values.data() + key * count;
    std::vector<T> authored(values, values + count);
    if (!input.indices.empty()) {
      authored.clear();
      for (const int index : input.indices) authored.push_back(values[index]);
    }
    expand(input.interpolation, authored, result.values);
  }
  const std::size_t each = result.values.size() / key_count(track.segments);
  if (input.interpolation == "constant" || (!curves_ && each == 1)) {
    result.interpolation = Interpolation::kConstant;
  } else if (!curves_ || input.interpolation == "uniform") {
    result.interpolation = Interpolation::kTriangle;
  }
  return result;
}

bool RoundShape::read_widths(const MeshInput& input, std::uint32_t max_segments, PrimLog& log) {
  const PrimvarInput<float>& given = input.round.widths;
  const std::size_t count = vertex_count();
  if (given.values.empty()) {
    log.warn_in_common("widths", message("not authored; drawn ", kDefaultWidth, " wide"));
    widths_ = {Interpolation::kVertex, 0, std::vector<float>(count, kDefaultWidth)};
    return true;
  }
  Primvar<float> found = expanded(given, "widths", max_segments, log);
  if (!found.authored()) return false;
  const std::size_t each = found.values.size() / key_count(found.segments);
  widths_ = {Interpolation::kVertex, found.segments, {}};
  for (std::uint32_t key = 0; key < key_count(found.segments); ++key) {
    const float* values = found.values.data() + key * each;
    std::vector<float> by_curve(curves_ && found.interpolation == Interpolation::kTriangle ? curves_->curves
                                                                                           : 0);
    for (std::size_t s = 0; s < (by_curve.empty() ? 0 : each); ++s)
      by_curve[curves_->span_curves[s]] = values[s];
    for (std::size_t v = 0; v < count; ++v) {
      const float width = !by_curve.empty() ? by_curve[curves_->vertex_curves[v]] : values[each == 1 ? 0 : v];
      widths_.values.push_back(width);
    }
  }
  drop_bad_widths(log);
  return true;
}

// A curve or point with a bad width, such as NaN or a negative one, is not drawn: all its widths become 0.
void RoundShape::drop_bad_widths(PrimLog& log) {
  const std::size_t count = vertex_count();
  const auto owner = [&](std::size_t v) { return curves_ ? curves_->vertex_curves[v] : std::uint32_t(v); };
  std::vector<bool> dropped(curves_ ? curves_->curves : point_count_, false);
  const float* first = nullptr;
  std::size_t dropped_count = 0, first_owner = 0;
  for (std::size_t i = 0; i < widths_.values.size(); ++i) {
    if (!is_bad_width(widths_.values[i]) || dropped[owner(i % count)]) continue;
    if (!first) first = &widths_.values[i], first_owner = owner(i % count);
    dropped[owner(i % count)] = true;
    ++dropped_count;
  }
  if (!first) return;
  log.warn("widths",
           message(dropped_count, " of ", dropped.size(), curves_ ? " curves" : " points",
                   " are not drawn: ", curves_ ? "curve " : "point ", first_owner, " has the width ", *first,
                   "; expected ones of at most 2^60 that are not negative"));
  for (std::size_t i = 0; i < widths_.values.size(); ++i) {
    if (dropped[owner(i % count)]) widths_.values[i] = 0.0f;
  }
}

std::vector<RoundVertex> RoundShape::vertices(const MovingArray& points, const Candidate& track) const {
  const std::vector<Vec3f> authored = point_controls(points, track);
  const std::size_t count = vertex_count();
  const TrackForm form = track.form();
  std::vector<RoundVertex> out;
  out.reserve(form.controls() * count);
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    // Between keys radii are linear, hence at even places of a curve's controls.
    double time01 = 0.0, within = 0.0;
    if (form.moving()) {
      const TimeLayout::Place place = track.layout.place(double(c) / (form.controls() - 1));
      time01 = place.time01, within = place.segment.middle();
    }
    const double half = 0.5 * mean_scale(points.transform.at(time01, within));
    const Vec3f* p = authored.data() + c * point_count_;
    for (std::size_t v = 0; v < count; ++v) {
      const double width = value_at(widths_, count, v, time01);
      out.push_back({curves_ ? mixed(p, curves_->terms_of(v)) : p[v], float(half * width)});
    }
  }
  return out;
}

void RoundShape::add_primvars(const MeshInput& input, const MaterialTable& materials,
                              std::uint32_t max_segments, Appearance& look, PrimLog& optional) const {
  const auto shown = [&]<typename T>(const PrimvarInput<T>& primvar, const std::string& attribute) {
    if (!check_colors(primvar, attribute, optional)) return Primvar<T>{};
    return expanded(primvar, attribute, max_segments, optional);
  };
  look.display_color = shown(input.display_color, "primvars:displayColor");
  look.display_opacity = shown(input.display_opacity, "primvars:displayOpacity");
  look.primvars = material_primvars(
      input, materials, [&](const NamedPrimvar& named) { return shown(named.primvar, full_name(named)); });
}

namespace {

// Whether curves scatter light as hair does: constant, 0 or 1.
bool is_fibre(const MeshInput& input, PrimLog& optional) {
  const auto named = std::ranges::find(input.named_primvars, kFibrePrimvar, &NamedPrimvar::name);
  if (named == input.named_primvars.end() || named->primvar.values.empty()) return false;
  const float first = named->primvar.values[0].x;
  const bool sound = named->primvar.interpolation == "constant" && (first == 0.0f || first == 1.0f);
  if (!sound) {
    optional.warn(full_name(*named), message("found ", named->primvar.interpolation, ", ", first,
                                             "; expected constant, 0 or 1; not shaded as hair"));
  }
  return sound && first == 1.0f;
}

}  // namespace

Curves RoundShape::curves(const MeshInput& input, const MovingArray& points, const Candidate& track,
                          const MaterialTable& materials, std::uint32_t max_segments,
                          PrimLog& optional) const {
  Curves out;
  out.shape.name = input.path;
  out.shape.segments = track.form().segments;
  out.shape.degree = track.form().degree;
  out.shape.vertex_count = std::uint32_t(vertex_count());
  out.shape.vertices = vertices(points, track);
  out.shape.shape = style_;
  if (normals_) {
    out.shape.normals =
        normals_->at_controls(points.transform, track.layout, track.form().controls(), *curves_);
  }
  out.shape.spans = curves_->spans;
  out.shape.loops = curves_->loops;
  out.span_curves = curves_->span_curves;
  out.fibre = is_fibre(input, optional);
  if (out.fibre && style_ == CurveShape::kOriented) {
    optional.warn("primvars:msbvh:fibre", "curves with normals are flat ribbons; not shaded as hair");
    out.fibre = false;
  }
  add_primvars(input, materials, max_segments, out, optional);
  return out;
}

Points RoundShape::points(const MeshInput& input, const MovingArray& points, const Candidate& track,
                          const MaterialTable& materials, std::uint32_t max_segments,
                          PrimLog& optional) const {
  Points out;
  out.shape.name = input.path;
  out.shape.segments = track.form().segments;
  out.shape.degree = track.form().degree;
  out.shape.point_count = std::uint32_t(point_count_);
  out.shape.vertices = vertices(points, track);
  add_primvars(input, materials, max_segments, out, optional);
  return out;
}

}  // namespace msbvh::translate
