#include "delegate/translate/frame/placed_levels.h"

#include <algorithm>
#include <cmath>

#include "delegate/translate/box_corners.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr Matrix4d kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
constexpr double kSmallest = 1e-30;

// Maps of one level that are sampled at the same times.
struct Choice {
  std::vector<std::uint32_t> which;
  InstanceLevel level;
  std::shared_ptr<const std::vector<Matrix4d>> storage;  // null: arrays
};

InstanceLevel array_level(const PlacedLevel& level) {
  InstanceLevel result;
  result.points = level.arrays.get();
  result.selected = level.selected;
  return result;
}

// Borrows.
InstanceLevel still_level(std::span<const Matrix4d> matrices) {
  InstanceLevel result;
  result.times01 = {0.0};
  result.matrices = matrices;
  return result;
}

Box3d box_of(std::span<const Vec3f> points) {
  Box3d box;
  for (const Vec3f& point : points) {
    const bool usable = std::abs(double(point.x)) <= kLargestElement &&
                        std::abs(double(point.y)) <= kLargestElement &&
                        std::abs(double(point.z)) <= kLargestElement;
    if (usable) box.grow(Vec3d(point));
  }
  return box;
}

Box3d image_of_arrays(const PointInstancerInput& arrays, const Box3d& box) {
  Box3d centres;
  for (const ArraySample& sample : arrays.positions.samples) centres.grow(box_of(sample.values));
  double scale = arrays.scales.empty() ? 1.0 : 0.0;
  for (const ArraySample& sample : arrays.scales.samples) {
    const Box3d scales = box_of(sample.values);
    if (!scales.empty()) scale = std::max({scale, length(scales.lo), length(scales.hi)});
  }
  if (centres.empty() || box.empty()) return {};
  double reach = 0.0;
  for (const Vec3d& corner : corners_of(box)) reach = std::max(reach, length(corner));
  const Vec3d around{scale * reach, scale * reach, scale * reach};
  return {centres.lo - around, centres.hi + around};
}

// The size of a pixel in the space that a level leads to: one for all its things.
PixelSize pixel_size(const PlacedLevel& level, const std::vector<InstanceLevel>& outer, const Box3d& box,
                     const Measure& measure) {
  if (level.motion->still()) return PixelSize::uniform(1.0);
  const std::vector<Matrix4d> identity{kIdentity};
  std::vector<InstanceLevel> around = outer;
  if (around.empty()) around.push_back(still_level(identity));
  return PixelSize::uniform(1.0 / std::max(measure(around, image_of(level, box)), kSmallest));
}

Choice choice_of(MotionSamples samples) {
  std::vector<double> periods01;
  for (const std::vector<double>& each : samples.periods01)
    periods01.insert(periods01.end(), each.begin(), each.end());
  std::ranges::sort(periods01);
  periods01.erase(std::unique(periods01.begin(), periods01.end()), periods01.end());
  Choice choice;
  choice.which = std::move(samples.which);
  choice.storage = std::make_shared<const std::vector<Matrix4d>>(std::move(samples.matrices));
  choice.level.times01 = std::move(samples.times01);
  choice.level.matrices = *choice.storage;
  choice.level.breakpoints01 = std::move(samples.breakpoints01);
  choice.level.held = samples.held;
  choice.level.periods01 = std::move(periods01);
  return choice;
}

// How one level is sampled.
std::vector<Choice> choices_of(const PlacedLevel& level, const std::vector<InstanceLevel>& outer,
                               const Box3d& box, const LevelSampling& how, std::size_t& unusable) {
  std::vector<Choice> choices;
  if (level.arrays) {
    choices.push_back({{}, array_level(level), nullptr});
    for (std::uint32_t i = 0; i < level.selected.size(); ++i) choices.back().which.push_back(i);
    return choices;
  }
  const PixelSize size = pixel_size(level, outer, box, how.measure);
  for (MotionSamples& samples :
       sample_motion(*level.motion, std::span(&box, 1), size, how.tolerance_pixels, level.motion->held())) {
    if (samples.usable) {
      choices.push_back(choice_of(std::move(samples)));
    } else {
      unusable += samples.which.size();
    }
  }
  return choices;
}

// Every part so far under every choice of the next level outwards, whose number counts most.
std::vector<SampledLevels> under(const std::vector<SampledLevels>& parts, const std::vector<Choice>& choices,
                                 std::size_t inner_count) {
  std::vector<SampledLevels> result;
  for (const Choice& choice : choices) {
    for (const SampledLevels& part : parts) {
      SampledLevels& both = result.emplace_back(part);
      both.levels.push_back(choice.level);
      if (choice.storage) both.storage.push_back(choice.storage);
      both.instances.clear();
      for (const std::uint32_t outer : choice.which) {
        for (const std::int32_t inner : part.instances)
          both.instances.push_back(std::int32_t(outer * inner_count) + inner);
      }
    }
  }
  return result;
}

}  // namespace

CoarseLevels::CoarseLevels(std::span<const PlacedLevel> levels) {
  storage_.reserve(levels.size());
  for (const PlacedLevel& level : levels) {
    if (level.arrays) {
      levels_.push_back(array_level(level));
      continue;
    }
    InstanceLevel& coarse = levels_.emplace_back();
    coarse.times01 = few_times01(*level.motion);
    storage_.push_back(matrices_at(*level.motion, coarse.times01));
    coarse.matrices = storage_.back();
  }
}

std::vector<InstanceLevel> CoarseLevels::from(std::size_t first) const {
  return {levels_.begin() + std::ptrdiff_t(first), levels_.end()};
}

Box3d image_of(const PlacedLevel& level, const Box3d& box) {
  if (level.arrays) return image_of_arrays(*level.arrays, box);
  Box3d image;
  if (box.empty()) return image;
  for (const Matrix4d& matrix : matrices_at(*level.motion, few_times01(*level.motion))) {
    const Affine3d map = affine_from(matrix);
    if (is_representable(map)) image.grow(bounds_of(corners_of(box), map));
  }
  return image;
}

LevelParts sample_levels(std::span<const PlacedLevel> levels, const Box3d& box, const LevelSampling& how) {
  const CoarseLevels coarse(levels);
  LevelParts result;
  result.parts.push_back({{}, {0}, {}});
  Box3d inner = box;
  std::size_t count = 1;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::vector<Choice> choices =
        choices_of(levels[i], coarse.from(i + 1), inner, how, result.unusable);
    result.parts = under(result.parts, choices, count);
    inner = image_of(levels[i], inner);
    count *= levels[i].count();
  }
  return result;
}

}  // namespace msbvh::translate
