// The benchmark's harness (bench/), for `msbvh bench`. Rows come as JSON: they are passed on, not looked
// into.
#include <memory>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <span>
#include <tuple>

#include "bench/run_scene.h"
#include "bench/stability.h"
#include "core/build/settings.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using bench::BenchScene;
using Ball = std::tuple<float, float, float, float>;

std::vector<std::string> builders() {
  std::vector<std::string> names;
  for (const BuilderName& builder : kBuilders) names.emplace_back(builder.name);
  return names;
}

nb::list forms(const std::vector<TrackForm>& forms) {
  nb::list result;
  for (const TrackForm& form : forms) result.append(nb::make_tuple(form.segments, form.degree));
  return result;
}

nb::list classes() {
  nb::list result;
  for (const bench::SceneClass& c : bench::scene_classes()) {
    nb::dict entry;
    entry["name"] = c.name;
    entry["what"] = c.what;
    entry["triangles"] = c.triangles;
    entry["quick_triangles"] = c.quick_triangles;
    entry["forms"] = forms(c.forms);
    entry["quick_forms"] = forms(c.quick_forms);
    result.append(entry);
  }
  return result;
}

std::tuple<SceneHandle, Ball> make(const std::string& name, std::uint32_t triangles, std::uint32_t segments,
                                   std::uint32_t degree, std::uint32_t seed) {
  const TrackForm form{segments, degree};
  if (!is_valid_form(form)) throw nb::value_error("segments, degree: expected a valid form of a track");
  const bench::SceneClass& kind = bench::scene_class(name.c_str());
  nb::gil_scoped_release release;
  BenchScene made = kind.make(triangles, form, seed);
  const Vec3f& c = made.interior.center;
  return {SceneHandle{std::move(made.scene), {}}, Ball{c.x, c.y, c.z, made.interior.radius}};
}

// A signal's exception ends the run between two measurements.
void heed_signals() {
  nb::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

std::vector<std::string> run(const SceneHandle& scene, const Ball& interior, const std::string& name,
                             const std::vector<std::string>& builders, const std::vector<unsigned>& threads,
                             std::size_t rays, int repetitions, int build_repetitions, std::uint32_t seed,
                             double oracle_tests, const std::vector<bool>& robust, const std::string& peer,
                             const std::string& peer_folder) {
  bench::RunSettings settings;
  settings.name = name;
  settings.builders = builders;
  settings.threads = threads;
  settings.rays = rays;
  settings.repetitions = repetitions;
  settings.build_repetitions = build_repetitions;
  settings.seed = seed;
  settings.oracle_tests = oracle_tests;
  settings.robust = robust;
  settings.tick = heed_signals;
  nb::gil_scoped_release release;
  std::optional<bench::PeerLibrary> library;
  if (!peer.empty()) settings.peer = &library.emplace(peer, peer_folder);
  const auto& [x, y, z, radius] = interior;
  return bench::run_scene({scene.scene, {{x, y, z}, radius}}, settings);
}

// (shape, motion, segments, degree, position, scale)
using Cell = std::tuple<std::string, std::string, std::uint32_t, std::uint32_t, double, double>;

std::vector<Cell> stability_cells() {
  std::vector<Cell> cells;
  for (const bench::StabilityCell& cell : bench::stability_cells())
    cells.emplace_back(cell.shape, cell.motion, cell.form.segments, cell.form.degree, cell.place.position,
                       cell.place.scale);
  return cells;
}

std::string run_stability(const Cell& cell, std::size_t rays, std::uint32_t seed, double oracle_tests,
                          const std::string& peer, const std::string& peer_folder) {
  const auto& [shape, motion, segments, degree, position, scale] = cell;
  bench::StabilitySettings settings{rays, seed, oracle_tests, nullptr, heed_signals};
  nb::gil_scoped_release release;
  std::optional<bench::PeerLibrary> library;
  if (!peer.empty()) settings.peer = &library.emplace(peer, peer_folder);
  return bench::run_stability({shape, motion, {segments, degree}, {position, scale}}, settings);
}

template <typename Named>
nb::dict what_is(std::span<const Named> all) {
  nb::dict result;
  for (const Named& one : all) result[one.name] = one.what;
  return result;
}

}  // namespace

void bind_bench(nb::module_& m) {
  m.def("builders", &builders);
  m.def("bench_classes", &classes);
  m.def("bench_scene", &make, nb::arg("name"), nb::kw_only(), nb::arg("triangles"), nb::arg("segments"),
        nb::arg("degree"), nb::arg("seed"));
  m.def("bench_run", &run, nb::arg("scene"), nb::arg("interior"), nb::kw_only(), nb::arg("name"),
        nb::arg("builders"), nb::arg("threads"), nb::arg("rays"), nb::arg("repetitions"),
        nb::arg("build_repetitions"), nb::arg("seed"), nb::arg("oracle_tests"), nb::arg("robust"),
        nb::arg("peer"), nb::arg("peer_folder"));
  m.def("stability_cells", &stability_cells);
  m.def("stability_shapes", [] { return what_is(bench::stability_shapes()); });
  m.def("stability_motions", [] { return what_is(bench::stability_motions()); });
  m.def("stability_run", &run_stability, nb::arg("cell"), nb::kw_only(), nb::arg("rays"), nb::arg("seed"),
        nb::arg("oracle_tests"), nb::arg("peer"), nb::arg("peer_folder"));
  m.def("bench_peer_name", [](const std::string& path, const std::string& folder) {
    return std::string(bench::PeerLibrary(path, folder).name());
  });
}

}  // namespace msbvh::python
