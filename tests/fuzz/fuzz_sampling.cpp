// When motion is read and what is kept of it: transforms, skeletons' poses, lights, cameras' optics. What is
// sampled covers the shutter at increasing times, is as many values as times, and stays in bounds of memory.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/light_samples.h"
#include "delegate/translate/look/optics.h"
#include "delegate/translate/sample/pose_sampler.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/sample/value_times.h"
#include "delegate/translate/time_layout.h"
#include "tests/fuzz/fuzzed_data.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;
using namespace msbvh::translate;

namespace {

std::vector<double> inner_times01(FuzzedData& data, std::uint32_t most) {
  std::vector<double> times = data.times01(data.below(most));
  if (!data.broken()) std::erase_if(times, [](double t) { return !(t > 0.0 && t < 1.0); });
  return times;
}

// Few: eight samples a turn, which a shutter of a million turns would ask for, are the caller's affair.
Turns fuzzed_turns(FuzzedData& data) {
  if (data.coin()) return {};
  if (data.coin()) return uniform_turns(data.wrong() ? data.real() : data.unit() * 4.0);
  std::vector<double> times{0.0, data.unit(), 1.0}, total{0.0, data.unit(), 1.0 + data.unit()};
  if (data.wrong()) total[1] = data.real();
  if (data.wrong()) times[1] = data.real();
  std::vector<double> periods;
  if (data.rarely()) periods.push_back(data.unit());
  const auto made = accepted([&] { return Turns(times, total, periods); });
  return made.value_or(Turns());
}

// Matrices between two, with a jump or a nasty element at times.
class FuzzedMotion : public MotionSource {
 public:
  explicit FuzzedMotion(FuzzedData& data) : count_(1 + data.below(3)), still_(data.rarely()) {
    breakpoints01_ = inner_times01(data, 6);
    for (std::size_t i = 0; i < count_; ++i) {
      turns_.push_back(fuzzed_turns(data));
      from_.push_back(data.matrix());
      to_.push_back(data.matrix());
    }
    wave_ = data.rarely() ? data.real() * 50.0 : 0.0;
    jump_at_ = data.rarely() ? data.unit() : 2.0;
  }
  std::size_t count() const override { return count_; }
  bool still() const override { return still_; }
  std::vector<double> breakpoints01() const override { return breakpoints01_; }
  Turns turns(std::uint32_t which) const override { return turns_[which]; }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override {
    require(out.size() == times01.size() * which.size(), "room for another number of matrices");
    evaluated_ += out.size();
    require(evaluated_ < 4'000'000, "sampled without bound");
    for (std::size_t t = 0; t < times01.size(); ++t) {
      for (std::size_t i = 0; i < which.size(); ++i) {
        require(which[i] < count_, "a thing that there is not");
        out[t * which.size() + i] = at(which[i], still_ ? 0.0 : times01[t]);
      }
    }
  }

 private:
  Matrix4d at(std::uint32_t thing, double time01) const {
    const double w = time01 >= jump_at_ ? 1.0 : time01 + std::sin(wave_ * time01);
    Matrix4d m;
    for (std::size_t e = 0; e < m.size(); ++e) m[e] = (1.0 - w) * from_[thing][e] + w * to_[thing][e];
    return m;
  }

  std::size_t count_;
  bool still_;
  std::vector<double> breakpoints01_;
  std::vector<Turns> turns_;
  std::vector<Matrix4d> from_, to_;
  double wave_, jump_at_;
  mutable std::size_t evaluated_ = 0;
};

PixelSize fuzzed_pixel_size(FuzzedData& data) {
  if (data.coin()) return PixelSize::uniform(data.positive());
  Box3d eye;
  eye.grow(Vec3d(data.points(1).front()));
  return {eye, data.coin(), data.positive(), data.positive()};
}

Box3d fuzzed_box(FuzzedData& data) {
  Box3d box;
  for (const Vec3f& p : data.points(data.rarely() ? 0 : 2)) box.grow(Vec3d(p));
  return box;
}

void require_increasing(const std::vector<double>& times01, const char* what) {
  require(!times01.empty(), what);
  for (std::size_t i = 0; i < times01.size(); ++i) {
    require(std::isfinite(times01[i]) && (i == 0 || times01[i] > times01[i - 1]), what);
  }
}

void sample_transforms(FuzzedData& data) {
  const FuzzedMotion motion(data);
  std::vector<Box3d> boxes{fuzzed_box(data)};
  if (data.coin()) boxes.assign(motion.count(), fuzzed_box(data));
  const auto samples =
      sample_motion(motion, boxes, fuzzed_pixel_size(data), data.one_of({0.1, 1.0, 1e-3}), data.rarely());
  std::vector<int> seen(motion.count());
  for (const MotionSamples& each : samples) {
    for (const std::uint32_t which : each.which) ++seen[which];
    if (!each.usable) continue;
    if (!data.broken()) require_increasing(each.times01, "sample times that do not increase");
    require(each.matrices.size() == each.times01.size() * each.which.size(),
            "matrices of another number of times");
    for (std::size_t place = 0; place < each.which.size(); ++place) {
      require(each.of(place).matrices.size() == each.times01.size(), "samples of another number of times");
    }
  }
  for (const int times : seen) require(times == 1, "a thing that is sampled twice, or not at all");
}

// A skeleton and the mesh that it moves.
class FuzzedPoses : public PoseSource {
 public:
  FuzzedPoses(FuzzedData& data, std::size_t joints, std::size_t shapes, const std::vector<Vec3f>& rest)
      : joints_(joints), shapes_(shapes), still_(data.rarely()), moves_rest_(data.rarely()), rest_(rest) {
    breakpoints01_ = inner_times01(data, 4);
    turns_ = fuzzed_turns(data);
    for (std::size_t i = 0; i < joints_; ++i) {
      from_.push_back(data.matrix());
      to_.push_back(data.matrix());
    }
    weights_ = data.reals(shapes_, -1.0f, 2.0f);
  }
  bool still() const override { return still_; }
  std::vector<double> breakpoints01() const override { return breakpoints01_; }
  Turns turns() const override { return turns_; }
  bool moves_rest() const override { return moves_rest_; }
  bool evaluate(std::span<const double> times01, PoseValues& out) const override {
    evaluated_ += times01.size();
    require(evaluated_ < 100'000, "posed without bound");
    for (const double time01 : times01) {
      for (std::size_t i = 0; i < joints_; ++i) {
        Matrix4d m;
        for (std::size_t e = 0; e < m.size(); ++e) m[e] = (1.0 - time01) * from_[i][e] + time01 * to_[i][e];
        out.joints.push_back(m);
      }
      for (const float weight : weights_) out.weights.push_back(weight * float(time01));
    }
    if (moves_rest_) out.rest = rest_;
    return true;
  }

 private:
  std::size_t joints_, shapes_;
  bool still_, moves_rest_;
  std::vector<Vec3f> rest_;
  std::vector<double> breakpoints01_;
  Turns turns_;
  std::vector<Matrix4d> from_, to_;
  std::vector<float> weights_;
  mutable std::size_t evaluated_ = 0;
};

void sample_poses(FuzzedData& data) {
  const std::size_t count = data.below(12), joints = data.below(4), shapes = data.below(3);
  const std::vector<Vec3f> points = data.points(count), normals = data.points(data.coin() ? count : 0);
  const FuzzedPoses source(data, joints, shapes, points);
  SkinningInput mesh;
  mesh.path = "/mesh";
  mesh.points = points;
  mesh.normals = normals;
  mesh.method = data.one_of({SkinningMethod::kLinear, SkinningMethod::kDualQuaternion});
  mesh.influences_per_point = data.wrong() ? data.one_of({0, -1, 2147483647}) : int(1 + data.below(3));
  mesh.constant_influences = data.coin();
  const std::size_t influences =
      std::size_t(std::clamp(mesh.influences_per_point, 0, 3)) * (mesh.constant_influences ? 1 : count);
  const std::vector<int> indices =
      data.ints(influences + (data.wrong() ? 1 : 0), 0, std::max(0, int(joints) - 1));
  const std::vector<float> weights = data.reals(influences, 0.0f, 1.0f);
  if (joints > 0) {
    mesh.joint_indices = indices;
    mesh.joint_weights = weights;
  }
  mesh.geom_bind = data.matrix();
  std::vector<std::vector<Vec3f>> offsets(shapes);
  std::vector<std::vector<int>> places(shapes);
  for (std::size_t s = 0; s < shapes; ++s) {
    offsets[s] = data.points(data.wrong() ? count + 1 : count);
    if (data.coin()) places[s] = data.ints(offsets[s].size(), 0, std::max(0, int(count) - 1));
    mesh.sub_shapes.push_back({"/shape", offsets[s], {}, places[s]});
  }
  std::vector<Diagnostic> said;
  PrimLog log(said, "/mesh");
  const FuzzedMotion placed(data);
  const auto poses =
      PoseSampler(mesh).sample(source, placed, fuzzed_pixel_size(data), 0.1, data.rarely(), log);
  for (const Diagnostic& d : said)
    require(!d.path.empty() && !d.message.empty(), "a message that names no prim");
  require(poses || !said.empty(), "no poses, and nothing said of it");
  if (!poses) return;
  if (!data.broken()) require_increasing(poses->times01, "pose times that do not increase");
  require(poses->poses.size() == poses->times01.size(), "poses of another number of times");
  for (const Pose& pose : poses->poses)
    require(pose.points->size() == count, "poses of another number of points");
}

LightSamples fuzzed_light(FuzzedData& data, std::vector<double> times01) {
  LightSamples light;
  light.times01 = std::move(times01);
  for (std::size_t i = 0; i < light.times01.size(); ++i) {
    light.emission.push_back({data.real(), data.real(), data.real()});
    LightNumbers& numbers = light.numbers.emplace_back();
    for (const LightNumber& each : kLightNumbers) numbers.*each.number = data.real();
    light.normalize.push_back(data.coin());
  }
  return light;
}

void sample_lights(FuzzedData& data) {
  const LightKind kind = LightKind(data.below(7));
  const std::vector<double> authored = inner_times01(data, 5), switched = inner_times01(data, 3);
  const std::vector<ValueTime> times = value_times(authored, switched);
  std::vector<double> times01;
  for (const ValueTime& time : times) {
    times01.push_back(time.time01);
    require(!time.authored || *time.authored < authored.size(), "a time that was not authored");
  }
  if (!data.broken()) require_increasing(times01, "value times that do not increase");
  LightSamples over = fuzzed_light(data, times01);
  LightSwitches switches{std::vector<bool>(times01.size(), true), {}};
  if (data.coin() && !switches.visible.empty())
    switches.visible[data.below(std::uint32_t(times01.size()))] = false;
  if (data.rarely()) switches.shown = std::vector<VisibleInterval>{{data.unit(), data.unit()}};
  const auto light = accepted([&] { return SampledLight(fuzzed_light(data, {0.0}), over, switches); });
  if (!light) return;
  const FuzzedMotion motion(data);
  const std::vector<double> places = light_times01(motion, data.rarely());
  if (!data.broken()) require_increasing(places, "light times that do not increase");
  const LightInput input =
      placed_light(kind, *light, motion, data.below(std::uint32_t(motion.count())), places, data.unit());
  require(input.values.size() == input.values_times01.size(), "values of another number of times");
}

void fit_windows(FuzzedData& data) {
  Optics optics;
  optics.projection = data.one_of({Projection::kPerspective, Projection::kOrthographic});
  for (double* value :
       {&optics.horizontal_aperture, &optics.vertical_aperture, &optics.horizontal_aperture_offset,
        &optics.vertical_aperture_offset, &optics.focal_length, &optics.f_stop, &optics.focus_distance}) {
    *value = data.real();
  }
  thin_lens(optics);
  conformed(window_of(optics), data.real(), AspectPolicy(data.below(5)));
  require(image_height(data.below(100'000), data.real()) >= 1, "an image without a line");
  aspect_policy(data.word({"expandAperture", "cropAperture", "adjustPixelAspectRatio"}));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  switch (data.below(4)) {
    case 0:
      sample_transforms(data);
      break;
    case 1:
      sample_poses(data);
      break;
    case 2:
      sample_lights(data);
      break;
    default:
      fit_windows(data);
  }
  return 0;
}
