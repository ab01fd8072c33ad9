// A picture by a renderer plugin in one of OpenUSD's own hosts, by a command line of usdrecord's kind:
//
//     hydra_draw --engine recorder|delegate|indices [--renderer HdMsbvhRendererPlugin] --camera /cam
//                --frames 1,2 --imageWidth 64 --imageHeight 48 [--set KEY=NUMBER]... [--dump FILE] [--waits]
//                SCENE OUT.exr
//
// `recorder` is UsdAppUtilsFrameRecorder, which usdrecord is a command line of; the height follows from the
// camera. `delegate` and `indices` are host.h's: OpenUSD's scene delegate, and its scene indices. All frames
// are drawn by one host; `delegate` and `indices` write the last one alone. With
// `--dump` they also write what they have handed over (dump.h), over the camera's shutter; with `--waits` how
// long each frame took, from the first execution of its pass. Exit code 1, with one line, for whatever cannot
// be drawn.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <pxr/imaging/hio/image.h>
#include <pxr/usd/usd/prim.h>
#include <pxr/usd/usdGeom/camera.h>
#ifdef MSBVH_HAS_RECORDER
#include <pxr/usdImaging/usdAppUtils/frameRecorder.h>
#endif
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/hydra/dump.h"
#include "tests/hydra/host.h"

using namespace msbvh::testing;
PXR_NAMESPACE_USING_DIRECTIVE

namespace {

struct Options {
  std::string engine = "delegate", renderer = "HdMsbvhRendererPlugin", camera, scene, out, dump;
  bool tell_waits = false;
  std::vector<double> frames{0.0};
  std::uint32_t width = 64, height = 64;
  std::vector<std::pair<std::string, double>> settings;
};

std::vector<double> numbers_of(const std::string& list) {
  std::vector<double> numbers;
  std::istringstream stream(list);
  for (std::string each; std::getline(stream, each, ',');) numbers.push_back(std::stod(each));
  return numbers;
}

Options options_of(const std::vector<std::string>& arguments) {
  Options options;
  std::vector<std::string> files;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& name = arguments[i];
    if (name.rfind("--", 0) != 0) {
      files.push_back(name);
      continue;
    }
    if (name == "--waits") {
      options.tell_waits = true;
      continue;
    }
    if (++i == arguments.size()) throw std::runtime_error(name + ": found no value");
    const std::string& value = arguments[i];
    if (name == "--engine")
      options.engine = value;
    else if (name == "--renderer")
      options.renderer = value;
    else if (name == "--camera")
      options.camera = value;
    else if (name == "--frames")
      options.frames = numbers_of(value);
    else if (name == "--imageWidth")
      options.width = std::uint32_t(std::stoul(value));
    else if (name == "--imageHeight")
      options.height = std::uint32_t(std::stoul(value));
    else if (name == "--dump")
      options.dump = value;
    else if (name == "--set")
      options.settings.emplace_back(value.substr(0, value.find('=')),
                                    std::stod(value.substr(value.find('=') + 1)));
    else
      throw std::runtime_error(name + ": found no such option");
  }
  if (files.size() != 2) throw std::runtime_error("expected a scene and a picture");
  options.scene = files[0];
  options.out = files[1];
  return options;
}

// `#` stand for a frame's digits as in usdrecord: `shot.####.exr`, `shot.####.###.exr` with those after the
// point.
std::string name_of(std::string out, double frame) {
  const std::size_t first = out.find('#');
  if (first == std::string::npos) return out;
  std::size_t end = std::min(out.find_first_not_of('#', first), out.size());
  std::size_t width = end - first, precision = 0;
  if (end + 1 < out.size() && out[end] == '.' && out[end + 1] == '#') {
    const std::size_t last = std::min(out.find_first_not_of('#', end + 1), out.size());
    precision = last - end - 1;
    width += precision + 1;
    end = last;
  }
  std::ostringstream digits;
  digits << std::fixed << std::setprecision(int(precision)) << std::setfill('0') << std::setw(int(width))
         << frame;
  return out.replace(first, end - first, digits.str());
}

void write(const Picture& picture, const std::string& file) {
  const HioImageSharedPtr image = HioImage::OpenForWriting(file);
  HioImage::StorageSpec storage;
  storage.width = int(picture.width);
  storage.height = int(picture.height);
  storage.depth = 1;
  storage.format = HioFormatFloat32Vec4;
  storage.flipped = false;
  storage.data = const_cast<float*>(picture.rgba.data());
  if (!image || !image->Write(storage)) throw std::runtime_error(file + ": cannot be written");
}

void draw_by_host(const Options& options, const UsdStageRefPtr& stage) {
  const Engine engine = options.engine == "indices" ? Engine::kSceneIndices : Engine::kSceneDelegate;
  Host host(stage, engine, SdfPath(options.camera), options.width, options.height, options.renderer.c_str());
  for (const auto& [key, value] : options.settings) host.set(key.c_str(), VtValue(value));
  for (const double frame : options.frames) {
    host.set_time(frame);
    const Host::Waits waits = host.converge();
    if (options.tell_waits)
      std::cout << "first picture after " << waits.first_picture << " s, converged after " << waits.converged
                << " s\n";
  }
  if (!options.dump.empty()) {
    const UsdGeomCamera camera(stage->GetPrimAtPath(SdfPath(options.camera)));
    double open = 0.0, close = 0.0;
    camera.GetShutterOpenAttr().Get(&open, UsdTimeCode(options.frames.back()));
    camera.GetShutterCloseAttr().Get(&close, UsdTimeCode(options.frames.back()));
    std::ofstream file(options.dump);
    dump(*host.scene(), float(open), float(close), file);
  }
  write(host.picture(), name_of(options.out, options.frames.back()));
}

#ifdef MSBVH_HAS_RECORDER
void draw_by_recorder(const Options& options, const UsdStageRefPtr& stage) {
  UsdAppUtilsFrameRecorder recorder(TfToken(options.renderer), false);
  recorder.SetImageWidth(options.width);
  recorder.SetColorCorrectionMode(TfToken("disabled"));
  recorder.SetCameraLightEnabled(false);
  const UsdGeomCamera camera(stage->GetPrimAtPath(SdfPath(options.camera)));
  for (const double frame : options.frames) {
    const std::string file = name_of(options.out, frame);
    if (!recorder.Record(stage, camera, UsdTimeCode(frame), file))
      throw std::runtime_error(file + ": the frame recorder wrote nothing");
  }
}
#endif

void draw(const Options& options) {
  const UsdStageRefPtr stage = UsdStage::Open(options.scene);
  if (!stage) throw std::runtime_error(options.scene + ": cannot be opened");
  if (!stage->GetPrimAtPath(SdfPath(options.camera)))
    throw std::runtime_error(options.scene + ": found no camera " + options.camera);
  if (options.engine == "delegate" || options.engine == "indices") return draw_by_host(options, stage);
#ifdef MSBVH_HAS_RECORDER
  if (options.engine == "recorder") return draw_by_recorder(options, stage);
#endif
  throw std::runtime_error("--engine: found no '" + options.engine + "' here");
}

}  // namespace

int main(int count, char** arguments) {
  try {
    draw(options_of({arguments + 1, arguments + count}));
  } catch (const std::exception& error) {
    std::cerr << "hydra_draw: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
