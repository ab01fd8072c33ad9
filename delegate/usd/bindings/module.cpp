// msbvh._core: what the Python package needs of the library, one to one. The typed contract is
// msbvh/_core.pyi.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "core/base/error.h"
#include "core/texture/texture_cache.h"
#include "core/trace/tracer.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

NB_MODULE(_core, m) {
  m.doc() = "The C++ side of msbvh: translator, builder and renderer.";
  m.attr("__version__") = MSBVH_VERSION;
  nb::exception<msbvh::Error>(m, "Error");
  msbvh::python::bind_scene(m);
  msbvh::python::bind_sample(m);
  msbvh::python::bind_mesh(m);
  msbvh::python::bind_level(m);
  msbvh::python::bind_look(m);
  msbvh::python::bind_frame(m);
  msbvh::python::bind_lights(m);
  msbvh::python::bind_shape(m);
  msbvh::python::bind_nurbs(m);
  msbvh::python::bind_materials(m);
  msbvh::python::bind_translator(m);
  msbvh::python::bind_skinning(m);
  msbvh::python::bind_plan(m);
  msbvh::python::bind_aovs(m);
  msbvh::python::bind_film(m);
  msbvh::python::bind_renderer(m);
  msbvh::python::bind_render_spec(m);
  msbvh::python::bind_bench(m);
  msbvh::python::bind_crash_line(m);
  msbvh::python::bind_pipe(m);
  m.def(
      "supported_instruction_sets",
      [] {
        std::vector<std::string> names;
        for (const msbvh::InstructionSet set : msbvh::supported_instruction_sets()) {
          names.emplace_back(msbvh::instruction_set_name(set));
        }
        return names;
      },
      "Those that the kernels are compiled for and this machine has; worst first.");
  m.def("can_read_textures", &msbvh::can_read_textures, "Whether this was built with OpenImageIO.");
}
