// Renderer: long work without the GIL, and Python's signals and exceptions heeded while it runs.
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/api/renderer.h"
#include "core/base/error.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

// How long Ctrl-C may go unheard during the build.
constexpr std::chrono::milliseconds kSignalInterval{50};

// What a name stands for, in a table of them.
template <typename Table, typename Row, typename Value>
Value named(const char* setting, const Table& table, Value Row::*member, const std::string& name) {
  std::string known;
  for (const Row& row : table) {
    if (name == row.name) return row.*member;
    known += (known.empty() ? "" : " or ") + std::string(row.name);
  }
  throw nb::value_error((std::string(setting) + ": found \"" + name + "\"; expected " + known).c_str());
}

// What `call`, or the handler of a signal that has arrived, raised; null if nothing. Needs the GIL.
template <typename Call>
std::exception_ptr exception_of(const Call& call) {
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    call();
    return nullptr;
  } catch (...) {
    return std::current_exception();
  }
}

// Builds on another thread, because its cancelled() is asked from any thread and only the main one hears
// signals.
void commit(Renderer& renderer, std::shared_ptr<const Scene> scene, RenderSettings settings) {
  std::atomic<bool> cancelled = false;
  settings.build.cancelled = [&cancelled] { return cancelled.load(std::memory_order_relaxed); };
  std::exception_ptr raised;
  nb::gil_scoped_release release;
  std::future<void> build =
      std::async(std::launch::async, [&] { renderer.commit(std::move(scene), settings); });
  while (build.wait_for(kSignalInterval) != std::future_status::ready) {
    if (cancelled) continue;
    nb::gil_scoped_acquire acquire;
    raised = exception_of([] {});
    if (raised) cancelled = true;
  }
  try {
    build.get();
  } catch (const Cancelled&) {
    if (!raised) throw;
  }
  nb::gil_scoped_acquire acquire;
  if (raised) std::rethrow_exception(raised);
}

// Hands values over to numpy without a copy, with `owner` kept alive.
nb::object to_array(const AovImage& aov, const Image& image, const nb::capsule& owner) {
  const std::size_t h = image.height, w = image.width, channels = form_of(aov.aov).numbers;
  if (form_of(aov.aov).is_id)
    return nb::cast(nb::ndarray<nb::numpy, const std::int32_t>(aov.ids.data(), {h, w}, owner));
  return nb::cast(nb::ndarray<nb::numpy, const float>(aov.values.data(), {h, w, channels}, owner));
}

// (pixels [h, w, 4], name -> values of each AOV).
nb::tuple to_arrays(Image image) {
  auto* owned = new Image(std::move(image));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<Image*>(p); });
  using Pixels = nb::ndarray<nb::numpy, float, nb::shape<-1, -1, 4>>;
  const Pixels pixels(owned->rgba.data(), {owned->height, owned->width, 4}, owner);
  nb::dict aovs;
  for (const AovImage& aov : owned->aovs) aovs[form_of(aov.aov).name] = to_array(aov, *owned, owner);
  return nb::make_tuple(pixels, aovs);
}

// What `work` returns, without the GIL, with a progress function that calls `progress` and cancels where that
// or a signal's handler raises, which is then raised here.
template <typename Work>
auto without_gil(const nb::object& progress, const Work& work) {
  std::exception_ptr raised;
  const ProgressFunction report = [&](double done) {
    nb::gil_scoped_acquire acquire;
    raised = exception_of([&] {
      if (!progress.is_none()) progress(done);
    });
    return !raised;
  };
  std::optional<decltype(work(report))> result;
  try {
    nb::gil_scoped_release release;
    result = work(report);
  } catch (const Cancelled&) {
    if (!raised) throw;
  }
  if (raised) std::rethrow_exception(raised);
  return std::move(*result);
}

nb::tuple render_with_aovs(Renderer& renderer, const nb::object& progress) {
  return to_arrays(
      without_gil(progress, [&](const ProgressFunction& report) { return renderer.render(report); }));
}

nb::tuple render_sliced(Renderer& renderer, const nb::object& progress, std::optional<double> seconds) {
  Image image = without_gil(progress, [&](const ProgressFunction& report) {
    return seconds ? renderer.render_within(*seconds, report) : renderer.render(report);
  });
  auto* slices = new std::vector<float>(std::move(image.slices));
  nb::capsule owner(slices, [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
  const std::size_t h = image.height, w = image.width, count = slices->size() / (4 * h * w);
  const nb::ndarray<nb::numpy, float> array(slices->data(), {count, h, w, 4}, owner);
  const nb::tuple rest = to_arrays(std::move(image));
  return nb::make_tuple(rest[0], rest[1], array);
}

using Hashes = nb::ndarray<const std::uint32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
nb::list crypto_manifest(const Renderer& renderer, const std::string& name, const Hashes& hashes) {
  nb::list names;
  for (const auto& [text, hash] :
       renderer.crypto_manifest(aovs_from({name}).front(), {hashes.data(), hashes.shape(0)}))
    names.append(nb::make_tuple(text, hash));
  return names;
}

nb::tuple render_samples(Renderer& renderer, std::uint32_t first, std::uint32_t count,
                         const nb::object& progress) {
  return to_arrays(without_gil(progress, [&](const ProgressFunction& report) {
    return renderer.render(SampleRange{first, count}, report);
  }));
}

nb::dict probe(const Renderer& renderer, std::size_t rays, std::uint64_t seed, const nb::object& progress) {
  ProbeSettings settings;
  settings.rays = rays;
  settings.seed = seed;
  const ProbeReport report =
      without_gil(progress, [&](const ProgressFunction& tell) { return renderer.probe(settings, tell); });
  nb::list rows;
  for (const ProbeResult& result : report.results) {
    nb::dict row;
    row["probe"] = result.probe;
    row["instruction_set"] = instruction_set_name(result.set);
    row["rays"] = result.rays;
    row["judged"] = result.judged;
    row["wrong"] = result.wrong;
    row["first"] = result.first;
    rows.append(row);
  }
  nb::dict found;
  found["meshes"] = report.meshes;
  found["closed_meshes"] = report.closed_meshes;
  found["probes"] = rows;
  return found;
}

// What a ray takes, in the mean over those counted.
nb::dict means(const TraceCounts& counts) {
  const auto mean = [&](std::uint64_t sum) {
    return counts.rays ? static_cast<double>(sum) / static_cast<double>(counts.rays) : 0.0;
  };
  nb::dict result;
  result["rays"] = counts.rays;
  result["nodes_per_ray"] = mean(counts.nodes);
  result["blocks_per_ray"] = mean(counts.blocks);
  result["tests_per_ray"] = mean(counts.primitives);
  result["instances_per_ray"] = mean(counts.instances);
  return result;
}

nb::list prim_costs(const RayCosts& costs) {
  nb::list prims;
  for (const PrimCosts& prim : costs.prims) {
    nb::dict row;
    row["path"] = prim.path;
    row["nodes"] = prim.nodes;
    row["blocks"] = prim.blocks;
    row["tests"] = prim.primitives;
    row["instances"] = prim.instances;
    row["share"] = prim.share;
    row["build_share"] = prim.build_share;
    row["tree_bytes"] = prim.tree_bytes;
    prims.append(row);
  }
  return prims;
}

nb::dict ray_costs(const Renderer& renderer, std::uint64_t camera_samples, const nb::object& progress) {
  const RayCosts costs = without_gil(progress, [&](const ProgressFunction& report) {
    return renderer.ray_costs({.camera_samples = camera_samples}, report);
  });
  nb::dict result = means(costs.all);
  result["paths"] = costs.paths;
  result["cost"] = costs.cost;
  result["camera"] = means(costs.camera);
  result["prims"] = prim_costs(costs);
  result["empty_nodes"] = costs.empty_nodes;
  result["empty_share"] = costs.empty_share;
  return result;
}

nb::object render(Renderer& renderer, const nb::object& progress) {
  return nb::object(render_with_aovs(renderer, progress)[0]);
}

std::vector<std::tuple<std::string, std::string, std::string>> plan(const Renderer& renderer) {
  std::vector<std::tuple<std::string, std::string, std::string>> reasons;
  for (const Reason& reason : renderer.plan().why) {
    reasons.emplace_back(effect_name(reason.effect), reason.prim, reason.why);
  }
  return reasons;
}

nb::dict accel_statistics(const BvhStatistics& s) {
  nb::dict result;
  result["triangles"] = s.triangles;
  result["quads"] = s.quads;
  result["instances"] = s.instances;
  result["references"] = s.references;
  result["nodes"] = s.nodes;
  result["leaves"] = s.leaves;
  result["node_bytes"] = s.node_bytes;
  result["leaf_bytes"] = s.leaf_bytes;
  result["vertex_bytes"] = s.vertex_bytes;
  result["grid_bytes"] = s.grid_bytes;
  result["instance_bytes"] = s.instance_bytes;
  result["other_bytes"] = s.other_bytes;
  result["topology_bytes"] = s.topology_bytes;
  result["total_bytes"] = s.total_bytes() + s.grid_bytes;
  result["max_segments"] = s.max_segments;
  result["depth"] = s.depth;
  result["sah_cost"] = s.sah_cost;
  result["build_seconds"] = s.build_seconds;
  result["topology_seconds"] = s.topology_seconds;
  result["bounds_seconds"] = s.bounds_seconds;
  result["refit_seconds"] = s.refit_seconds;
  result["built"] = s.built;
  result["refitted"] = s.refitted;
  result["kept"] = s.kept;
  return result;
}

// Those that any thread was found at.
nb::list stage_rows(const StageCounts& counts) {
  nb::list rows;
  for (std::size_t code = 0; code < counts.of_code.size(); ++code) {
    const StageNow now = StageNow::of(code);
    if (counts.of_code[code] == 0 || now.stage == Stage::kNone) continue;
    nb::dict row;
    row["stage"] = stage_name(now.stage);
    row["tracing"] = now.tracing;
    row["bounced"] = now.bounced;
    row["samples"] = counts.of_code[code];
    rows.append(row);
  }
  return rows;
}

nb::dict statistics(const Renderer& renderer) {
  const RenderStatistics& s = renderer.statistics();
  nb::dict result;
  result["build_seconds"] = s.build_seconds;
  result["trace_seconds"] = s.trace_seconds;
  result["rays"] = s.rays.rays();
  result["rays_in_packets"] = s.rays.packets;
  result["rays_interleaved"] = s.rays.interleaved;
  result["rays_single"] = s.rays.single;
  result["camera_rays"] = s.camera_rays;
  result["spp"] = s.spp;
  result["trees"] = s.trees;
  result["stages"] = stage_rows(s.stages);
  result["accel"] = accel_statistics(s.accel);
  return result;
}

// (texture as authored, file, reason) of each.
nb::list texture_faults(const Renderer& renderer) {
  nb::list faults;
  for (const TextureFault& fault : renderer.texture_faults())
    faults.append(nb::make_tuple(renderer.texture_name(fault.texture), fault.file, fault.reason));
  return faults;
}

void commit_scene(Renderer& self, const SceneHandle& scene, std::uint32_t width, std::uint32_t height,
                  std::uint32_t spp, std::uint32_t seed, std::uint32_t max_bounces, std::uint32_t threads,
                  bool show_domes, const std::string& builder, const std::string& layout,
                  const std::string& refit, bool keep_topology, const std::vector<std::string>& aovs,
                  const std::string& sampler, float split_budget, bool sample_stages,
                  const FilmSettings& film, double texture_memory_mb, float noise, std::uint32_t min_spp,
                  float clamp_indirect, float texture_rate, bool refraction,
                  const std::string& rendering_space) {
  RenderSettings settings{.width = width,
                          .height = height,
                          .spp = spp,
                          .sampling = named("sampler", kSamplings, &SamplingName::sampling, sampler),
                          .seed = seed,
                          .max_bounces = max_bounces,
                          .threads = threads,
                          .show_domes = show_domes,
                          .refraction = refraction,
                          .build = {}};
  settings.build.builder = named("builder", kBuilders, &BuilderName::builder, builder);
  settings.build.layout = named("layout", kTreeLayouts, &TreeLayoutName::layout, layout);
  settings.build.refit = named("refit", kRefits, &RefitName::refit, refit);
  settings.build.keep_topology = keep_topology;
  settings.build.spatial_split_budget = split_budget;
  settings.aovs = aovs_from(aovs);
  settings.sample_stages = sample_stages;
  settings.film = film;
  settings.textures.memory_limit_bytes = static_cast<std::uint64_t>(texture_memory_mb * 1048576.0);
  settings.textures.rendering_space = rendering_space;
  settings.film.origin = scene.origin;
  settings.noise = {noise, min_spp};
  settings.clamp_indirect = clamp_indirect;
  settings.texture_rate = texture_rate;
  commit(self, scene.scene, std::move(settings));
}

template <typename... Settings>
void init(Renderer* self, const SceneHandle& scene, Settings... settings) {
  new (self) Renderer();
  try {
    commit_scene(*self, scene, settings...);
  } catch (...) {
    self->~Renderer();
    throw;
  }
}

}  // namespace

void bind_renderer(nb::module_& m) {
  const RenderSettings defaults;
  const auto def_with_settings = [&defaults](nb::class_<Renderer>& renderer, const char* name,
                                             const auto& function) {
    renderer.def(name, function, nb::arg("scene"), nb::kw_only(), nb::arg("width"), nb::arg("height"),
                 nb::arg("spp") = defaults.spp, nb::arg("seed") = defaults.seed,
                 nb::arg("max_bounces") = defaults.max_bounces, nb::arg("threads") = defaults.threads,
                 nb::arg("show_domes") = defaults.show_domes, nb::arg("builder") = "msbvh",
                 nb::arg("layout") = "full", nb::arg("refit") = "auto",
                 nb::arg("keep_topology") = defaults.build.keep_topology,
                 nb::arg("aovs") = std::vector<std::string>(), nb::arg("sampler") = "sobol",
                 nb::arg("split_budget") = defaults.build.spatial_split_budget,
                 nb::arg("sample_stages") = defaults.sample_stages, nb::arg("film") = FilmSettings(),
                 nb::arg("texture_memory_mb") = double(defaults.textures.memory_limit_bytes >> 20),
                 nb::arg("noise") = defaults.noise.target, nb::arg("min_spp") = defaults.noise.min_spp,
                 nb::arg("clamp_indirect") = defaults.clamp_indirect,
                 nb::arg("texture_rate") = defaults.texture_rate, nb::arg("refraction") = defaults.refraction,
                 nb::arg("rendering_space") = defaults.textures.rendering_space);
  };
  nb::class_<Renderer> renderer(m, "Renderer");
  def_with_settings(
      renderer, "__init__",
      &init<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, bool,
            const std::string&, const std::string&, const std::string&, bool, const std::vector<std::string>&,
            const std::string&, float, bool, const FilmSettings&, double, float, std::uint32_t, float, float,
            bool, const std::string&>);
  def_with_settings(renderer, "commit", &commit_scene);
  renderer.def("render", &render, nb::arg("progress") = nb::none())
      .def("render_with_aovs", &render_with_aovs, nb::arg("progress") = nb::none())
      .def("render_sliced", &render_sliced, nb::arg("progress") = nb::none(),
           nb::arg("time_limit") = nb::none())
      .def("crypto_manifest", &crypto_manifest, nb::arg("aov"), nb::arg("hashes"))
      .def("render_samples", &render_samples, nb::arg("first"), nb::arg("count"),
           nb::arg("progress") = nb::none())
      .def("verify", &Renderer::verify, nb::call_guard<nb::gil_scoped_release>())
      .def("probe", &probe, nb::kw_only(), nb::arg("rays"), nb::arg("seed"), nb::arg("progress") = nb::none())
      .def("ray_costs", &ray_costs, nb::kw_only(),
           nb::arg("camera_samples") = RayCostSettings{}.camera_samples, nb::arg("progress") = nb::none())
      .def_prop_ro("texture_faults", &texture_faults)
      .def_prop_ro("plan", &plan)
      .def_prop_ro("statistics", &statistics);
}

}  // namespace msbvh::python
