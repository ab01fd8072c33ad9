// The parts that make up the extension module.
#pragma once

#include <memory>
#include <nanobind/nanobind.h>
#include <string>
#include <vector>

#include "core/film/aov.h"
#include "core/scene/scene.h"

namespace msbvh::python {

// A finished scene on its way from the translator to the renderer; next to opaque in Python.
struct SceneHandle {
  std::shared_ptr<const Scene> scene;
  Vec3d origin;  // of the frame's world, in stage space
};

// By aov_names(). Throws Error for another one.
std::vector<Aov> aovs_from(const std::vector<std::string>& names);

void bind_scene(nanobind::module_& m);
void bind_scene_look(nanobind::class_<SceneHandle>& scene);
void bind_sample(nanobind::module_& m);
void bind_mesh(nanobind::module_& m);
void bind_level(nanobind::module_& m);
void bind_look(nanobind::module_& m);
void bind_frame(nanobind::module_& m);
void bind_lights(nanobind::module_& m);
void bind_nurbs(nanobind::module_& m);
void bind_shape(nanobind::module_& m);
void bind_materials(nanobind::module_& m);
void bind_translator(nanobind::module_& m);
void bind_skinning(nanobind::module_& m);
void bind_plan(nanobind::module_& m);
void bind_aovs(nanobind::module_& m);
void bind_film(nanobind::module_& m);
void bind_renderer(nanobind::module_& m);
void bind_render_spec(nanobind::module_& m);
void bind_bench(nanobind::module_& m);
void bind_crash_line(nanobind::module_& m);
void bind_pipe(nanobind::module_& m);

}  // namespace msbvh::python
