#include "delegate/translate/sample/sampler.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "delegate/translate/sample/stretches.h"

namespace msbvh::translate {
namespace {

// The most often that a stretch between breakpoints is halved: 4096 samples.
constexpr int kFinestSplit = 12;
// Matrices that are held at once, a gigabyte; beyond it sampling ends where it stands, and says so by its
// error.
constexpr std::size_t kMostMatrices = std::size_t(1) << 23;
// By which halving the distance of samples divides the error: a line's by four, a cubic's by 16, of which
// half counts.
constexpr double kLineGain = 4.0, kCubicGain = 8.0;

using Which = std::vector<std::uint32_t>;
using Matrices = std::vector<Matrix4d>;  // [time][thing]

bool is_usable(const Matrix4d& matrix) {
  return std::ranges::all_of(matrix, [](double x) { return std::abs(x) <= kLargestElement; });
}

// Those columns of `things` that a thing's flag says.
Matrices columns(const Matrices& all, std::size_t things, const std::vector<bool>& wanted) {
  Matrices some;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted[i % things]) some.push_back(all[i]);
  }
  return some;
}

template <typename T>
std::vector<T> chosen(const std::vector<T>& all, const std::vector<bool>& wanted) {
  std::vector<T> some;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted[i]) some.push_back(all[i]);
  }
  return some;
}

bool any(const std::vector<bool>& flags) { return std::ranges::find(flags, true) != flags.end(); }
bool all(const std::vector<bool>& flags) { return std::ranges::find(flags, false) == flags.end(); }

// One set of samples, or the usable things and the others apart.
std::vector<MotionSamples> by_use(MotionSamples samples) {
  std::vector<bool> good(samples.which.size(), true);
  for (std::size_t i = 0; i < samples.matrices.size(); ++i) {
    if (!is_usable(samples.matrices[i])) good[i % good.size()] = false;
  }
  std::vector<MotionSamples> parts;
  if (all(good)) {
    parts.push_back(std::move(samples));
    return parts;
  }
  for (const bool usable : {true, false}) {
    std::vector<bool> wanted = good;
    if (!usable) wanted.flip();
    if (!any(wanted)) continue;
    MotionSamples& part = parts.emplace_back();
    part.which = chosen(samples.which, wanted);
    part.times01 = samples.times01;
    part.matrices = columns(samples.matrices, good.size(), wanted);
    part.breakpoints01 = samples.breakpoints01;
    part.held = samples.held;
    part.usable = usable;
  }
  return parts;
}

Vec3d corner(const Box3d& box, std::size_t i) {
  return {i & 4 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 1 ? box.hi.z : box.lo.z};
}

Vec3d moved(const Vec3d& p, const Matrix4d& m) {
  return {p.x * m[0] + p.y * m[4] + p.z * m[8] + m[12], p.x * m[1] + p.y * m[5] + p.z * m[9] + m[13],
          p.x * m[2] + p.y * m[6] + p.z * m[10] + m[14]};
}

// Samples of one motion, refined for the things that still need it.
class Refinement {
 public:
  Refinement(const MotionSource& source, std::span<const Box3d> boxes, const PixelSize& pixel_size,
             double limit)
      : source_(source),
        boxes_(boxes),
        pixel_size_(pixel_size),
        limit_(limit),
        breakpoints01_(source.breakpoints01()),
        stretches_(breakpoints01_) {}

  std::vector<MotionSamples> sampled();

 private:
  Matrices evaluated(std::span<const double> times01, const Which& which) const;
  Matrices refined(int split) const;
  CornerSamples corners(const Matrices& matrices) const;
  std::vector<double> pixel_sizes(const CornerSamples& corners) const;
  void find_needed_splits();
  void refine(int split);
  void keep(const std::vector<bool>& wanted);
  MotionSamples samples(std::vector<double> times01, const Matrices& matrices,
                        const std::vector<bool>& wanted) const;

  const MotionSource& source_;
  std::span<const Box3d> boxes_;
  const PixelSize& pixel_size_;
  double limit_;
  std::vector<double> breakpoints01_;
  Stretches stretches_;

  // Of the things that are left:
  Which which_;
  std::vector<Turns> turns_;
  std::vector<int> needed_;  // how often a stretch must be halved at least
  Matrices coarse_;          // at the times of the split
  Matrices probed_;

  std::vector<MotionSamples> done_;
};

Matrices Refinement::evaluated(std::span<const double> times01, const Which& which) const {
  Matrices matrices(times01.size() * which.size());
  if (!matrices.empty()) source_.evaluate(times01, which, matrices);
  return matrices;
}

// At the times of the next split.
Matrices Refinement::refined(int split) const {
  const std::vector<double> times01 = stretches_.times01(split + 1);
  const std::vector<bool> kept = stretches_.kept(split);
  std::vector<double> unknown01;
  for (std::size_t t = 0; t < times01.size(); ++t) {
    if (!kept[t]) unknown01.push_back(times01[t]);
  }
  const Matrices found = evaluated(unknown01, which_);
  const std::size_t things = which_.size();
  Matrices fine;
  fine.reserve(times01.size() * things);
  Matrices::const_iterator known = coarse_.begin(), next = found.begin();
  for (std::size_t t = 0; t < times01.size(); ++t) {
    Matrices::const_iterator& from = kept[t] ? known : next;
    fine.insert(fine.end(), from, from + std::ptrdiff_t(things));
    from += std::ptrdiff_t(things);
  }
  return fine;
}

CornerSamples Refinement::corners(const Matrices& matrices) const {
  CornerSamples corners{which_.size(), {}};
  corners.points.reserve(8 * matrices.size());
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const Box3d& own = boxes_.size() == 1 ? boxes_.front() : boxes_[which_[i % which_.size()]];
    const Box3d box = own.empty() ? Box3d{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}} : own;
    for (std::size_t c = 0; c < 8; ++c) corners.points.push_back(moved(corner(box, c), matrices[i]));
  }
  return corners;
}

std::vector<double> Refinement::pixel_sizes(const CornerSamples& corners) const {
  std::vector<Box3d> around(corners.things);
  for (std::size_t i = 0; i < corners.points.size(); ++i)
    around[i / 8 % corners.things].grow(corners.points[i]);
  std::vector<double> sizes;
  for (const Box3d& box : around) sizes.push_back(pixel_size_.at_box(box));
  return sizes;
}

// So that a turn has kTimesATurn samples.
void Refinement::find_needed_splits() {
  turns_.clear();
  needed_.clear();
  for (const std::uint32_t which : which_) {
    turns_.push_back(source_.turns(which));
    const double most =
        turns_.back().none() ? 0.0 : std::ranges::max(turns_.back().within(stretches_.ends01()));
    needed_.push_back(int(std::min(std::ceil(std::log2(std::max(kTimesATurn * most, 1.0))), 1000.0)));
  }
}

MotionSamples Refinement::samples(std::vector<double> times01, const Matrices& matrices,
                                  const std::vector<bool>& wanted) const {
  MotionSamples samples;
  samples.which = chosen(which_, wanted);
  samples.times01 = std::move(times01);
  samples.matrices = columns(matrices, which_.size(), wanted);
  samples.breakpoints01 = breakpoints01_;
  for (const Turns& turns : chosen(turns_, wanted)) samples.periods01.push_back(turns.periods01());
  return samples;
}

void Refinement::keep(const std::vector<bool>& wanted) {
  coarse_ = columns(coarse_, which_.size(), wanted);
  probed_ = columns(probed_, which_.size(), wanted);
  which_ = chosen(which_, wanted);
  turns_ = chosen(turns_, wanted);
  needed_ = chosen(needed_, wanted);
}

// How far things may be from where a motion that turns faster than it is sampled shows them: as far as they
// ever are from each other.
std::vector<double> reaches(const CornerSamples& corners) {
  std::vector<Box3d> around(corners.things);
  for (std::size_t i = 0; i < corners.points.size(); ++i)
    around[i / 8 % corners.things].grow(corners.points[i]);
  std::vector<double> reaches;
  for (const Box3d& box : around) reaches.push_back(length(box.extent()));
  return reaches;
}

// What is good enough at this split is done; the rest goes on to the next.
void Refinement::refine(int split) {
  Matrices fine = refined(split);
  const std::vector<double> times01 = stretches_.times01(split + 1);
  const CornerSamples at_coarse = corners(coarse_), at_fine = corners(fine);
  const std::vector<double> bent = stretches_.strays(split, at_coarse, times01, at_fine);
  const std::vector<double> beside =
      stretches_.strays(split + 1, at_fine, stretches_.probes01(), corners(probed_));
  const std::vector<double> sizes = pixel_sizes(at_fine), reach = reaches(at_fine);
  const double gain = split < Stretches::kCubicSplit ? kLineGain : kCubicGain;
  const bool is_last = split + 1 == kFinestSplit || 2 * fine.size() > kMostMatrices;
  std::vector<bool> good;
  double error_pixels = 0.0;
  for (std::size_t i = 0; i < which_.size(); ++i) {
    const double off = bent[i] / sizes[i], probed_off = beside[i] / sizes[i];
    // Ends alone do where they are exact; between them and a cubic's four, samples are a test, not yet a
    // track.
    const bool follows = split == 0 ? off <= limit_ && probed_off <= limit_
                                    : off <= gain * limit_ && probed_off <= limit_ && split > 1;
    good.push_back((follows && needed_[i] <= split) || is_last);
    if (!good.back()) continue;
    raise_to(error_pixels, split == 0 ? off : off / gain);
    if (needed_[i] > split) raise_to(error_pixels, reach[i] / sizes[i]);
  }
  if (any(good)) {
    done_.push_back(split == 0 ? samples(stretches_.times01(0), coarse_, good)
                               : samples(times01, fine, good));
    done_.back().error_pixels = error_pixels;
  }
  coarse_ = std::move(fine);
  good.flip();
  keep(good);
}

std::vector<MotionSamples> Refinement::sampled() {
  which_.resize(source_.count());
  std::iota(which_.begin(), which_.end(), 0u);
  MotionSamples ends;
  ends.which = which_;
  ends.times01.assign(stretches_.ends01().begin(), stretches_.ends01().end());
  ends.matrices = evaluated(ends.times01, which_);
  ends.breakpoints01 = breakpoints01_;
  which_.clear();
  // No splitting would make a number of what is none.
  for (MotionSamples& part : by_use(std::move(ends))) {
    if (part.usable) {
      which_ = std::move(part.which);
      coarse_ = std::move(part.matrices);
    } else {
      done_.push_back(std::move(part));
    }
  }
  if (which_.empty()) return std::move(done_);
  find_needed_splits();
  probed_ = evaluated(stretches_.probes01(), which_);
  int split = std::min(std::ranges::min(needed_), kFinestSplit - 1);
  if (split > 0) coarse_ = evaluated(stretches_.times01(split), which_);
  for (; !which_.empty(); ++split) refine(split);
  return std::move(done_);
}

std::vector<MotionSamples> sampled_once(const MotionSource& source, std::vector<double> times01,
                                        std::span<const double> evaluated_at01, bool held) {
  MotionSamples samples;
  samples.which.resize(source.count());
  std::iota(samples.which.begin(), samples.which.end(), 0u);
  samples.matrices.resize(times01.size() * samples.which.size());
  source.evaluate(evaluated_at01, samples.which, samples.matrices);
  samples.times01 = std::move(times01);
  samples.breakpoints01 = source.breakpoints01();
  samples.held = held;
  return by_use(std::move(samples));
}

std::vector<MotionSamples> held_samples(const MotionSource& source) {
  std::vector<double> times01{0.0}, middles01;
  for (const double time01 : source.breakpoints01()) {
    if (time01 > 0.0) times01.push_back(time01);
  }
  // In the middle of what holds: a time that is rounded might lie before its own sample.
  for (std::size_t i = 0; i < times01.size(); ++i) {
    middles01.push_back(0.5 * (times01[i] + (i + 1 < times01.size() ? times01[i + 1] : 1.0)));
  }
  return sampled_once(source, std::move(times01), middles01, true);
}

}  // namespace

TransformSamples MotionSamples::of(std::size_t place) const {
  TransformSamples samples;
  samples.times01 = times01;
  for (std::size_t t = 0; t < times01.size(); ++t)
    samples.matrices.push_back(matrices[t * which.size() + place]);
  samples.breakpoints01 = breakpoints01;
  samples.held = held;
  samples.error_pixels = error_pixels;
  if (!periods01.empty()) samples.periods01 = periods01[place];
  return samples;
}

std::vector<MotionSamples> sample_motion(const MotionSource& source, std::span<const Box3d> boxes,
                                         const PixelSize& pixel_size, double tolerance_pixels, bool held) {
  if (source.count() == 0) return {};
  if (source.still()) return sampled_once(source, {0.0}, std::vector<double>{0.0}, false);
  if (held) return held_samples(source);
  if (boxes.size() != 1 && boxes.size() != source.count()) {
    throw Error("boxes: found " + std::to_string(boxes.size()) + "; expected one, or one for each of " +
                std::to_string(source.count()) + " things");
  }
  return Refinement(source, boxes, pixel_size, kSamplingShare * tolerance_pixels).sampled();
}

}  // namespace msbvh::translate
