#include "core/bvh/instance_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/lerp.h"
#include "core/build/clip.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

// A time remap rounds its local time to within 2^-25 (core/motion/time_remap.h); pieces of a track are taken
// wider by this on either side.
constexpr double kTimeRemapError = 0x1p-24;

Vec3d corner(const Box3d& b, int i) {
  return {(i & 1) ? b.hi.x : b.lo.x, (i & 2) ? b.hi.y : b.lo.y, (i & 4) ? b.hi.z : b.lo.z};
}

// By map.point() of each corner, to the bit; what corners share is added up once.
void grow_by_image(Box3d& out, const Affine3d& map, const Box3d& box) {
  const Vec3d y[2] = {map.y * box.lo.y, map.y * box.hi.y}, z[2] = {map.z * box.lo.z, map.z * box.hi.z};
  for (const Vec3d& x : {map.x * box.lo.x, map.x * box.hi.x}) {
    for (const Vec3d& y_part : y) {
      const Vec3d xy = x + y_part;
      for (const Vec3d& z_part : z) out.grow(xy + z_part + map.t);
    }
  }
}

Vec3d error_of(const Affine3d& m, const Box3d& b, std::uint32_t degree) {
  const Vec3d x = max(abs(b.lo), abs(b.hi));
  return (abs(m.x) * x.x + abs(m.y) * x.y + abs(m.z) * x.z + abs(m.t)) * (kInstancePad * degree);
}

Box3d in_double(const Box3f& b) { return {Vec3d(b.lo), Vec3d(b.hi)}; }
Affine3d in_double(const Affine3f& m) { return Affine3d(m); }

// Control `j` of a track's part that covers segment `k` of a grid of `segments`.
template <typename T>
auto part_of(const RemappedTrack<T>& track, std::uint32_t segments, std::uint32_t k, std::uint32_t j) {
  if (!track.form.moving()) return in_double(track.controls[0]);
  const std::uint32_t ratio = segments / track.form.segments;
  const T* first = track.controls.data() + (k / ratio) * track.form.degree;
  return part_control([&](std::uint32_t i) { return in_double(first[i]); }, track.form.degree,
                      double(k % ratio) / ratio, double(k % ratio + 1) / ratio, j);
}

// Boxes at controls and what each is padded by; a pad counts for all controls of the segments it belongs to.
class PaddedBoxes {
 public:
  explicit PaddedBoxes(const TrackForm& form)
      : form_(form), boxes_(form.controls()), pads_(form.controls()) {}

  Box3d& box(std::uint32_t control) { return boxes_[control]; }
  void pad(std::uint32_t control, const Vec3d& pad) { pads_[control] = max(pads_[control], pad); }

  InstanceBounds finish() const {
    InstanceBounds out{form_, {}};
    out.controls.reserve(form_.controls());
    const std::uint32_t last = form_.controls() - 1, reach = form_.degree;
    for (std::uint32_t c = 0; c <= last; ++c) {
      Vec3d pad{};
      for (std::uint32_t i = c < reach ? 0 : c - reach; i <= std::min(c + reach, last); ++i) {
        pad = max(pad, pads_[i]);
      }
      out.controls.push_back(round_outwards({boxes_[c].lo - pad, boxes_[c].hi + pad}));
    }
    return out;
  }

 private:
  TrackForm form_;
  std::vector<Box3d> boxes_;
  std::vector<Vec3d> pads_;
};

// At most one of both moves.
InstanceBounds bound_by_controls(const RemappedTrack<Affine3f>& transform,
                                 const RemappedTrack<Box3f>& object) {
  const TrackForm form = transform.form.moving() ? transform.form : object.form;
  PaddedBoxes out(form);
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    const Affine3d map(transform.controls[transform.form.moving() ? c : 0]);
    const Box3d box = in_double(object.controls[object.form.moving() ? c : 0]);
    grow_by_image(out.box(c), map, box);
    out.pad(c, error_of(map, box, form.degree));
  }
  return out.finish();
}

double binomial(std::uint32_t n, std::uint32_t k) {
  double result = 1.0;
  for (std::uint32_t i = 1; i <= k; ++i) result *= double(n - k + i) / i;
  return result;
}

// The product of two tracks on one segment: controls of a corner's path.
class Product {
 public:
  Product(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object,
          std::uint32_t segments, std::uint32_t k)
      : m_(transform.form.degree), n_(object.form.degree) {
    for (std::uint32_t i = 0; i <= m_; ++i) maps_[i] = part_of(transform, segments, k, i);
    for (std::uint32_t i = 0; i <= n_; ++i) boxes_[i] = part_of(object, segments, k, i);
  }
  std::uint32_t degree() const { return m_ + n_; }
  Vec3d control(int c, std::uint32_t index) const {
    Vec3d sum{};
    for (std::uint32_t i = index > n_ ? index - n_ : 0; i <= std::min(index, m_); ++i) {
      const double weight = binomial(m_, i) * binomial(n_, index - i) / binomial(m_ + n_, index);
      sum += maps_[i].point(corner(boxes_[index - i], c)) * weight;
    }
    return sum;
  }
  Vec3d error() const {
    Vec3d pad{};
    for (std::uint32_t i = 0; i <= m_; ++i) {
      for (std::uint32_t j = 0; j <= n_; ++j) pad = max(pad, error_of(maps_[i], boxes_[j], std::max(m_, n_)));
    }
    return pad;
  }

 private:
  std::uint32_t m_, n_;
  Affine3d maps_[kMaxDegree + 1];
  Box3d boxes_[kMaxDegree + 1];
};

// A path of degree n leaves its chord by sum B_i(u) d_i over its inner controls' deviations d_i, and those
// weights sum to 1 - u^n - (1 - u)^n, at most 1 - 2^(1 - n).
void grow_by_path(const Product& product, int c, Box3d& at_begin, Box3d& at_end) {
  const std::uint32_t n = product.degree();
  const Vec3d begin = product.control(c, 0), end = product.control(c, n);
  Vec3d below{}, above{};
  for (std::uint32_t i = 1; i < n; ++i) {
    const Vec3d deviation = product.control(c, i) - lerp(begin, end, double(i) / n);
    below = min(below, deviation);
    above = max(above, deviation);
  }
  const double share = 1.0 - std::ldexp(1.0, 1 - int(n));
  for (const Vec3d& swell : {below * share, above * share}) {
    at_begin.grow(begin + swell);
    at_end.grow(end + swell);
  }
}

InstanceBounds bound_by_chords(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object) {
  const TrackForm form{std::max(transform.form.segments, object.form.segments), 1};
  PaddedBoxes out(form);
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const Product product(transform, object, form.segments, k);
    for (int c = 0; c < 8; ++c) grow_by_path(product, c, out.box(k), out.box(k + 1));
    out.pad(k, product.error());
    out.pad(k + 1, product.error());
  }
  return out.finish();
}

// Calls f with the index of each control that is in force at some time within [a, b] of the shutter; with
// some of them twice, where a time remap has several pieces there.
template <typename T, typename F>
void for_controls_within(const RemappedTrack<T>& track, double a, double b, const F& f) {
  if (!track.form.moving()) return f(0u);
  const auto add = [&](double from, double to) {
    const std::uint32_t segments = track.form.segments, degree = track.form.degree;
    const auto key = [&](double time) {
      return std::min(std::uint32_t(std::clamp(time, 0.0, 1.0) * segments), segments - 1);
    };
    const std::uint32_t first = key(from - kTimeRemapError), last = key(to + kTimeRemapError);
    for (std::uint32_t c = first * degree; c <= (last + 1) * degree; ++c) f(c);
  };
  if (!track.time_remap || track.time_remap->is_shutter()) return add(a, b);
  for (std::size_t i = 0; i < track.time_remap->pieces.size(); ++i) {
    const TimeRemapPiece& piece = track.time_remap->pieces[i];
    const double begin = piece.begin, end = track.time_remap->end_of(i);
    if (!piece.visible || begin > b || end < a) continue;
    const auto local = [&](double u) {
      const double w = end > begin ? std::clamp((u - begin) / (end - begin), 0.0, 1.0) : 0.0;
      return lerp(double(piece.from), double(piece.to), w);
    };
    add(local(a), local(b));
  }
}

// The object's boxes at its controls, under the transform at its own. Most controls are in force in several
// parts of the shutter; where only one of both moves, each has its image made once.
class Images {
 public:
  struct Image {
    Box3d box;
    Vec3d error;
  };

  Images(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object)
      : transform_(transform), object_(object) {
    const std::uint32_t maps = transform.form.controls(), boxes = object.form.controls();
    if (std::min(maps, boxes) > 1) return;
    known_.reserve(std::max(maps, boxes));
    for (std::uint32_t c = 0; c < std::max(maps, boxes); ++c)
      known_.push_back(image(maps > 1 ? c : 0, boxes > 1 ? c : 0));
  }
  Image operator()(std::uint32_t map, std::uint32_t box) const {
    return known_.empty() ? image(map, box) : known_[map + box];
  }

 private:
  Image image(std::uint32_t m, std::uint32_t b) const {
    const Affine3d map(transform_.controls[m]);
    const Box3d box = in_double(object_.controls[b]);
    Image result{{}, error_of(map, box, kMaxDegree)};
    grow_by_image(result.box, map, box);
    return result;
  }

  const RemappedTrack<Affine3f>& transform_;
  const RemappedTrack<Box3f>& object_;
  std::vector<Image> known_;  // by the control of the one that moves
};

InstanceBounds bound_by_parts(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object) {
  const TrackForm form{kRemappedSegments, 1};
  const Images images(transform, object);
  PaddedBoxes out(form);
  Box3d all;
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const double a = double(k) / form.segments, b = double(k + 1) / form.segments;
    for_controls_within(transform, a, b, [&](std::uint32_t map) {
      for_controls_within(object, a, b, [&](std::uint32_t box) {
        const Images::Image image = images(map, box);
        for (const std::uint32_t key : {k, k + 1}) {
          out.box(key).grow(image.box);
          out.pad(key, image.error);
        }
        all.grow(image.box);
      });
    });
  }
  // Hidden throughout a part: a place is needed all the same, and one beside the others costs least.
  for (std::uint32_t k = 0; k < form.controls(); ++k) {
    if (!out.box(k).empty()) continue;
    if (all.empty()) return {};  // never seen
    out.box(k) = {all.center(), all.center()};
  }
  return out.finish();
}

bool has_time_remap(const TimeRemap* time_remap) { return time_remap && !time_remap->is_shutter(); }

}  // namespace

InstanceBounds bound_instance(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object) {
  if (object.controls.empty() || object.controls[0].empty()) return {};
  if (has_time_remap(transform.time_remap) || has_time_remap(object.time_remap))
    return bound_by_parts(transform, object);
  if (transform.form.moving() && object.form.moving()) return bound_by_chords(transform, object);
  return bound_by_controls(transform, object);
}

}  // namespace msbvh
