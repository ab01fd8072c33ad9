#include "delegate/translate/frame/held_parts.h"

#include <algorithm>
#include <functional>
#include <string>

#include "core/base/lerp.h"
#include "delegate/translate/frame/held_values.h"

namespace msbvh::translate {
namespace {

// One value that may change within the shutter.
struct Course {
  std::string attribute;
  std::vector<double> times01;
  std::function<bool(double, double)> same;  // at two times
};

std::span<const int> held_at(const HeldIndices& indices, double time01) {
  std::span<const int> held = indices.samples.front().second;
  for (const auto& [begin01, values] : indices.samples) {
    if (begin01 <= time01) held = values;
  }
  return held;
}

bool is_given(const HeldIndices& indices) { return indices.samples.size() > 1; }

Course course_of(const std::string& attribute, const HeldIndices& indices) {
  Course course{attribute, {}, {}};
  for (const auto& [time01, values] : indices.samples) course.times01.push_back(time01);
  course.same = [&indices](double a, double b) {
    return std::ranges::equal(held_at(indices, a), held_at(indices, b));
  };
  return course;
}

template <typename T>
std::vector<double> times_of(const PrimvarInput<T>& primvar) {
  std::vector<double> times01;
  for (const PrimvarSample<T>& sample : primvar.samples) times01.push_back(sample.time01);
  return times01;
}

// As USD evaluates an array: samples of another size than the next one's hold.
template <typename T>
std::vector<T> values_at(const PrimvarInput<T>& primvar, double time01, bool hold) {
  const auto& samples = primvar.samples;
  if (samples.empty()) return {primvar.values.begin(), primvar.values.end()};
  const auto after =
      std::size_t(std::ranges::upper_bound(samples, time01, {}, &PrimvarSample<T>::time01) - samples.begin());
  const PrimvarSample<T>& lower = samples[after == 0 ? 0 : after - 1];
  const PrimvarSample<T>& upper = samples[std::min(after, samples.size() - 1)];
  std::vector<T> values(lower.values.begin(), lower.values.end());
  const double length = upper.time01 - lower.time01;
  if (hold || after == 0 || !(length > 0.0) || upper.values.size() != values.size()) return values;
  const auto w = float((time01 - lower.time01) / length);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = lerp(values[i], upper.values[i], w);
  return values;
}

// Values are held where the stage says so, and where their number changes with the indices: each of them has
// a track of its own.
template <typename T>
bool values_hold(const PrimvarInput<T>& primvar, const HeldPrimvar& held) {
  if (primvar.samples.size() < 2) return false;
  if (held.values) return true;
  const std::size_t size = primvar.samples.front().values.size();
  return (is_given(held.indices) || !primvar.indices.empty()) &&
         std::ranges::any_of(primvar.samples, [&](const auto& each) { return each.values.size() != size; });
}

template <typename T>
void add_courses(const std::string& name, const PrimvarInput<T>& primvar, const HeldPrimvar& held,
                 std::vector<Course>& courses) {
  if (is_given(held.indices)) courses.push_back(course_of(name + ":indices", held.indices));
  if (!values_hold(primvar, held)) return;
  courses.push_back({name, times_of(primvar), [&primvar, hold = held.values](double a, double b) {
                       return values_at(primvar, a, hold) == values_at(primvar, b, hold);
                     }});
}

std::vector<Course> courses_of(const FrameShape& shape) {
  std::vector<Course> courses;
  const HeldShapeValues& held = shape.held;
  if (is_given(held.holes)) courses.push_back(course_of("holeIndices", held.holes));
  if (is_given(held.normals_indices))
    courses.push_back(course_of("primvars:normals:indices", held.normals_indices));
  add_courses("primvars:displayColor", shape.mesh.display_color, held.display_color, courses);
  add_courses("primvars:displayOpacity", shape.mesh.display_opacity, held.display_opacity, courses);
  for (const BoundSubset& subset : shape.subsets) {
    if (is_given(subset.held)) courses.push_back(course_of(subset.faces.path + ".indices", subset.held));
  }
  return courses;
}

// The opening, and where anything may change after it. What begins at the closing is not seen.
std::vector<double> begins_of(const std::vector<Course>& courses) {
  std::vector<double> begins01{0.0};
  for (const Course& course : courses) {
    std::ranges::copy_if(course.times01, std::back_inserter(begins01),
                         [](double time01) { return time01 > 0.0 && time01 < 1.0; });
  }
  std::ranges::sort(begins01);
  begins01.erase(std::unique(begins01.begin(), begins01.end()), begins01.end());
  return begins01;
}

std::vector<HeldStretch> stretches_of(const std::vector<Course>& courses, std::span<const double> begins01) {
  std::vector<std::size_t> kinds, first;  // of each time; where each kind is met first
  for (const double begin01 : begins01) {
    const auto same = [&](std::size_t known) {
      return std::ranges::all_of(courses,
                                 [&](const Course& course) { return course.same(begins01[known], begin01); });
    };
    const auto found = std::ranges::find_if(first, same);
    kinds.push_back(std::size_t(found - first.begin()));
    if (found == first.end()) first.push_back(kinds.size() - 1);
    if (first.size() > kMostStretches) return {};
  }
  return held_stretches(begins01, kinds);
}

// Of a primvar over a part of the shutter.
template <typename T>
void hold_primvar(const HeldPrimvar& held, const HeldStretch& stretch, double begin01,
                  std::deque<std::vector<T>>& storage, PrimvarInput<T>& primvar) {
  const PrimvarInput<T> whole = primvar;
  if (is_given(held.indices)) primvar.indices = held_at(held.indices, begin01);
  if (!is_given(held.indices) && !values_hold(whole, held)) return;
  const auto kept = [&](double time01) -> std::span<const T> {
    return storage.emplace_back(values_at(whole, time01, held.values));
  };
  primvar.values = kept(begin01);
  primvar.samples.clear();
  if (held.values || whole.samples.size() < 2) return;
  const Visibility& shown = stretch.shown;
  const std::vector<double> authored01 = times_of(whole);
  for (const double time01 : shown ? knots_within(authored01, *shown) : authored01)
    primvar.samples.push_back({time01, kept(time01)});
}

FrameShape part_of(const FrameShape& whole, const HeldStretch& stretch, double begin01, ShapeParts& parts) {
  FrameShape part = whole;
  part.held = {};
  part.mesh.visible = common_intervals(whole.mesh.visible, stretch.shown);
  const HeldShapeValues& held = whole.held;
  if (is_given(held.holes)) part.mesh.hole_indices = held_at(held.holes, begin01);
  if (is_given(held.normals_indices)) part.mesh.normals_indices = held_at(held.normals_indices, begin01);
  hold_primvar(held.display_color, stretch, begin01, parts.colors, part.mesh.display_color);
  hold_primvar(held.display_opacity, stretch, begin01, parts.opacities, part.mesh.display_opacity);
  for (BoundSubset& subset : part.subsets) {
    if (is_given(subset.held)) subset.faces.indices = held_at(subset.held, begin01);
    subset.held = {};
  }
  return part;
}

void warn_of_change(const std::vector<Course>& courses, const std::vector<double>& begins01,
                    const std::string& message, PrimLog& log) {
  for (const Course& course : courses) {
    const bool changes = std::ranges::any_of(
        begins01, [&](double begin01) { return !course.same(begins01.front(), begin01); });
    if (changes) log.warn(course.attribute, message);
  }
}

// All of it as at the frame.
FrameShape frame_alone(const FrameShape& whole) {
  FrameShape shape = whole;
  shape.held = {};
  for (BoundSubset& subset : shape.subsets) subset.held = {};
  if (values_hold(whole.mesh.display_color, whole.held.display_color) ||
      is_given(whole.held.display_color.indices))
    shape.mesh.display_color.samples.clear();
  if (values_hold(whole.mesh.display_opacity, whole.held.display_opacity) ||
      is_given(whole.held.display_opacity.indices))
    shape.mesh.display_opacity.samples.clear();
  return shape;
}

}  // namespace

bool holds_values(const FrameShape& shape) { return !courses_of(shape).empty(); }

ShapeParts parts_of(const FrameShape& shape, PrimLog& log) {
  ShapeParts parts;
  const std::vector<Course> courses = courses_of(shape);
  const std::vector<double> begins01 = begins_of(courses);
  if (shape.mesh.topology_varies) {
    warn_of_change(courses, begins01, "changes within the shutter; held the frame's value, as its topology",
                   log);
    parts.shapes.push_back(frame_alone(shape));
    return parts;
  }
  const std::vector<HeldStretch> stretches = stretches_of(courses, begins01);
  if (stretches.empty()) {
    warn_of_change(courses, begins01,
                   message("found more values within the shutter, expected at most ", kMostStretches,
                           "; held the frame's"),
                   log);
    parts.shapes.push_back(frame_alone(shape));
    return parts;
  }
  for (const HeldStretch& stretch : stretches) {
    FrameShape part = part_of(shape, stretch, begins01[stretch.first], parts);
    if (!part.mesh.visible || !part.mesh.visible->empty()) parts.shapes.push_back(std::move(part));
  }
  return parts;
}

}  // namespace msbvh::translate
