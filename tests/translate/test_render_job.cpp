// delegate/translate/frame: pictures that grow by samples, the thread that renders them, and first looks.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <doctest/doctest.h>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/frame/assemble.h"
#include "delegate/translate/frame/kept_origin.h"
#include "delegate/translate/frame/preview.h"
#include "delegate/translate/frame/render_job.h"
#include "delegate/translate/frame/sample_sum.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class NoTextures : public TextureSource {
 public:
};

// A quad that moves to the right, and the camera above it at `x`.
AssembledFrame quad_frame(double x, std::optional<Vec3d> last_origin) {
  const testing::MeshFixture mesh;
  FrameShape shape;
  shape.mesh = mesh.input();
  const auto shifted = [](double x) { return testing::row_vector_matrix(testing::translation({x, 0, 0})); };
  shape.motion = std::make_shared<SampledMotion>(std::vector{0.0, 1.0}, std::vector{shifted(0), shifted(1)});
  FrameInput frame;
  frame.camera = testing::camera_at({x, 0, 10});
  frame.shutter = {-0.25, 0.25};
  frame.groups.emplace_back().shapes.push_back(shape);
  TranslatorSettings settings = testing::settings_of();
  settings.origin = kept_origin(last_origin, frame.camera, settings.width, settings.height);
  return assemble_frame(frame, settings, NoTextures());
}

std::shared_ptr<const Scene> quad_scene() { return quad_frame(0.0, std::nullopt).scene; }

struct LastPicture : PictureSink {
  void show(const Image& picture, std::uint32_t count, bool last) override {
    const std::scoped_lock lock(mutex);
    shown = picture;
    samples.push_back(count);
    finished = last;
    changed.notify_all();
  }
  void failed(const std::string& why) override {
    const std::scoped_lock lock(mutex);
    fault = why;
    finished = true;
    changed.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return finished; });
  }

  std::mutex mutex;
  std::condition_variable changed;
  Image shown;
  std::vector<std::uint32_t> samples;
  bool finished = false;
  std::string fault;
};

RenderSettings small_settings(std::uint32_t spp) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.spp = spp;
  settings.threads = 1;
  return settings;
}

}  // namespace

TEST_CASE("ranges of samples make the picture of all") {
  const std::shared_ptr<const Scene> scene = quad_scene();
  RenderSettings settings = small_settings(24);
  settings.aovs = {Aov::kCameraDepth, Aov::kPrimId, Aov::kNormal};
  Renderer renderer;
  renderer.commit(scene, settings);
  const Image whole = renderer.render();
  SampleSum sum;
  for (SampleRange range = next_samples(0, 24); range.count > 0; range = next_samples(sum.samples(), 24))
    sum.add(renderer.render(range), range.count);
  CHECK(sum.samples() == 24);
  const Image summed = sum.picture();
  for (std::size_t i = 0; i < whole.rgba.size(); ++i)
    CHECK(double(summed.rgba[i]) == doctest::Approx(double(whole.rgba[i])).epsilon(1e-5));
  CHECK(summed.aovs[0].values == whole.aovs[0].values);
  CHECK(summed.aovs[1].ids == whole.aovs[1].ids);
  settings.aovs = {};
  renderer.commit(scene, settings);
  const Image other = renderer.render(SampleRange{0, 1});
  CHECK_THROWS_AS(sum.add(other, 1), Error);
}

TEST_CASE("samples come one, one, two, four, then a block at a time") {
  std::vector<std::uint32_t> counts;
  for (std::uint32_t done = 0; done < 70;) {
    counts.push_back(next_samples(done, 70).count);
    done += counts.back();
  }
  CHECK(counts == std::vector<std::uint32_t>{1, 1, 2, 4, 8, 16, 16, 16, 6});
  CHECK(next_samples(70, 70).count == 0);
  CHECK(with_depth({Aov::kNormal}) == std::vector{Aov::kNormal});
  CHECK(with_depth({Aov::kPrimId}) == std::vector{Aov::kPrimId, Aov::kCameraDepth});
}

TEST_CASE("a job shows more and more samples, and ends converged") {
  const std::shared_ptr<const Scene> scene = quad_scene();
  LastPicture sink;
  RenderJob job(sink);
  CHECK_FALSE(job.status().converged);
  job.start(scene, small_settings(5));
  sink.wait();
  job.stop();
  CHECK(sink.samples == std::vector<std::uint32_t>{1, 2, 4, 5});
  CHECK(sink.fault.empty());
  CHECK(job.status().converged);
  CHECK(job.status().samples == 5);
  const Image first = sink.shown;
  sink.finished = false;
  job.restart();
  sink.wait();
  CHECK(sink.shown.rgba == first.rgba);
}

TEST_CASE("where noise decides, a job ends with the picture that a renderer makes at once") {
  for (const std::uint32_t spp : {16u, 200u}) {
    RenderSettings settings = small_settings(spp);
    settings.noise.target = 0.01f;
    settings.aovs = {Aov::kSampleCount};
    LastPicture sink;
    RenderJob job(sink);
    job.start(quad_scene(), settings);
    sink.wait();
    Renderer renderer;
    renderer.commit(quad_scene(), settings);
    const Image whole = renderer.render();
    CHECK(sink.shown.aovs[0].values == whole.aovs[0].values);
    if (spp > 32) CHECK(sink.shown.rgba == whole.rgba);
    CHECK(sink.samples.back() == spp);
  }
}

TEST_CASE("a job that is stopped or paused shows nothing more, and one that fails says why") {
  const std::shared_ptr<const Scene> scene = quad_scene();
  LastPicture sink;
  RenderJob job(sink);
  job.pause();
  job.start(scene, small_settings(1000000));
  while (job.status().samples == 0) std::this_thread::yield();
  const std::uint32_t samples = job.status().samples;
  CHECK(job.status().paused);
  CHECK(samples == 1);  // it waits after its first step
  job.resume();
  while (job.status().samples == samples) std::this_thread::yield();
  job.stop();
  const std::size_t shown = sink.samples.size();
  CHECK(job.status().stopped);
  CHECK_FALSE(job.status().converged);
  CHECK(sink.samples.size() == shown);

  auto broken = std::make_shared<Scene>(*scene);
  broken->meshes[0].shape.triangles[0] = {90, 91, 92};
  job.start(broken, small_settings(4));
  sink.wait();
  CHECK_FALSE(sink.fault.empty());
  job.start(scene, small_settings(2));  // it goes on
  job.stop();
}

TEST_CASE("a first look has as few pixels as its time allows") {
  CHECK(preview_divisor(100, 100, 1e-9) == 1);
  CHECK(preview_divisor(1920, 1080, kPreviewSeconds / (1920.0 * 1080.0)) == 1);
  CHECK(preview_divisor(1920, 1080, 2.0 * kPreviewSeconds / (1920.0 * 1080.0)) == 2);
  CHECK(preview_divisor(1920, 1080, 1.0) == 64);  // 16 rows at least
  CHECK(preview_divisor(31, 4000, 1.0) == 1);
}

TEST_CASE("an enlarged picture has the nearest pixels, whatever the sizes") {
  Image small{2, 2, std::vector<float>(16), {}};
  for (std::size_t i = 0; i < 16; ++i) small.rgba[i] = float(i);
  small.aovs.emplace_back(Aov::kPrimId, 4);
  small.aovs[0].ids = {1, 2, 3, 4};
  const Image large = enlarged(small, 5, 3);
  CHECK(large.aovs[0].ids == std::vector<std::int32_t>{1, 1, 1, 2, 2, 1, 1, 1, 2, 2, 3, 3, 3, 4, 4});
  CHECK(large.rgba.size() == 60);
  CHECK(large.rgba[4 * 14] == 12.0f);
}

TEST_CASE("a preview is the picture in fewer pixels, and no part of the sum") {
  RenderSettings settings = small_settings(4);
  settings.width = 64;
  settings.height = 48;
  settings.aovs = {Aov::kPrimId};
  Renderer renderer;
  renderer.commit(quad_scene(), settings);
  const Image before = renderer.render(SampleRange{0, 1});
  const std::uint64_t rays = renderer.statistics().camera_rays;
  const Image small = renderer.preview(16, 12);
  CHECK(small.width == 16);
  CHECK(small.height == 12);
  CHECK(renderer.statistics().camera_rays == rays);
  CHECK(renderer.render(SampleRange{0, 1}).rgba == before.rgba);
  const auto covered = [](const Image& picture) {
    double sum = 0.0;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) sum += double(picture.rgba[i]);
    return sum / (double(picture.width) * picture.height);
  };
  CHECK(covered(small) == doctest::Approx(covered(before)).epsilon(0.2));
  CHECK_THROWS_AS(renderer.preview(65, 48), Error);
}

TEST_CASE("a large picture is shown small first") {
  RenderSettings settings = small_settings(2);
  settings.width = 1280;
  settings.height = 720;
  settings.threads = 0;
  LastPicture sink;
  RenderJob job(sink);
  job.start(quad_scene(), settings);
  sink.wait();
  job.stop();
  REQUIRE(sink.samples.size() == 3);
  CHECK(sink.samples == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(sink.shown.width == 1280);
  CHECK(job.status().first_picture_seconds > 0.0);
  // A sixteenth of the pixels, and without the trees of a scene of one quad.
  CHECK(job.status().first_picture_seconds < 0.5 * job.status().seconds);
}

TEST_CASE("a camera that moves a little keeps the trees, one that goes far has an origin of its own") {
  const AssembledFrame first = quad_frame(0.0, std::nullopt), moved = quad_frame(0.5, first.origin),
                       fresh = quad_frame(0.5, std::nullopt), far = quad_frame(1e6, first.origin);
  CHECK(moved.origin == first.origin);
  CHECK(fresh.origin.x == doctest::Approx(0.5));
  CHECK(far.origin.x == doctest::Approx(1e6));
  RenderSettings settings = small_settings(16);
  settings.build.keep_topology = true;
  Renderer renderer;
  renderer.commit(first.scene, settings);
  CHECK(renderer.statistics().accel.kept == 0);
  renderer.commit(moved.scene, settings);
  CHECK(renderer.statistics().accel.built == 0);
  CHECK(renderer.statistics().accel.refitted == 0);
  CHECK(renderer.statistics().accel.kept > 0);
  const Image kept = renderer.render();
  Renderer alone;
  alone.commit(fresh.scene, settings);
  const Image same = alone.render();
  double most = 0.0;
  for (std::size_t i = 0; i < kept.rgba.size(); ++i)
    most = std::max(most, std::abs(double(kept.rgba[i]) - double(same.rgba[i])));
  CHECK(most <= 1.0 / 16.0 + 1e-6);  // of 16 samples one may fall on the other side of an edge
}

TEST_CASE("any order of orders ends with the last scene's picture, and a job may go at any time") {
  const std::vector<std::shared_ptr<const Scene>> scenes{quad_frame(0.0, std::nullopt).scene,
                                                         quad_frame(1.0, std::nullopt).scene,
                                                         quad_frame(3.0, std::nullopt).scene};
  std::mt19937 random(7);
  for (int round = 0; round < 10; ++round) {
    LastPicture sink;
    RenderJob job(sink);
    for (int i = 0; i < 40; ++i) {
      const std::shared_ptr<const Scene>& scene = scenes[random() % scenes.size()];
      switch (random() % 8) {
        case 0:
          job.stop();
          break;
        case 1:
          job.stop(false);
          break;
        case 2:
          job.pause();
          break;
        case 3:
          job.resume();
          break;
        case 4:
          job.restart();
          break;
        case 5:
          job.give_up();
          break;
        default:
          job.start(scene, small_settings(1 + random() % 40));
          break;
      }
      if (random() % 2) std::this_thread::sleep_for(std::chrono::microseconds(random() % 500));
    }
    CHECK(sink.fault.empty());
    if (round % 2) continue;  // it goes in the middle of whatever it is at
    job.stop();
    CHECK_FALSE(job.status().tracing);
    sink.finished = false;
    job.resume();
    job.start(scenes[1], small_settings(4));
    sink.wait();
    Renderer alone;
    alone.commit(scenes[1], small_settings(4));
    const Image picture = alone.render();
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      CHECK(double(sink.shown.rgba[i]) == doctest::Approx(double(picture.rgba[i])).epsilon(1e-5));
  }
}
