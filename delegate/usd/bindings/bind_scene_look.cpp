// What a finished scene's surfaces are made of, for tests and reports: plain dicts and arrays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "core/scene/scene.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

constexpr const char* kInputs[] = {"diffuse_color", "emissive_color", "specular_color",      "metallic",
                                   "roughness",     "clearcoat",      "clearcoat_roughness", "opacity",
                                   "ior",           "normal"};
constexpr const char* kInterpolations[] = {"constant", "triangle", "vertex", "faceVarying"};
constexpr const char* kWraps[] = {"useMetadata", "black", "clamp", "repeat", "mirror"};

nb::tuple tuple_of(const Vec3f& v) { return nb::make_tuple(v.x, v.y, v.z); }

nb::object name_of(const Scene& scene, PrimvarName name) {
  return name == kNoPrimvar ? nb::none() : nb::cast(scene.primvar_names[name]);
}

nb::dict dict_of(const TextureRead& read, const Scene& scene) {
  nb::dict result;
  result["texture"] = read.texture;
  result["coordinates"] = name_of(scene, read.coordinates);
  result["fallback_coordinates"] = read.fallback_coordinates;
  result["matrix"] = read.matrix;
  result["offset"] = read.offset;
  result["scale"] = read.scale;
  result["bias"] = read.bias;
  return result;
}

nb::dict dict_of(const DrivenInput& input, const Scene& scene) {
  nb::dict result;
  if (input.source == DrivenInput::Source::kTexture) {
    result["texture_read"] = input.index;
  } else {
    result["primvar"] = name_of(scene, input.index);
  }
  result["channel"] = unsigned(input.channel);
  result["grey"] = input.grey;
  return result;
}

void add_constants(const Material& material, nb::dict& result) {
  result["name"] = material.name;
  result["diffuse_color"] = tuple_of(material.diffuse_color);
  result["diffuse_from_display_color"] = material.diffuse_from_display_color;
  result["emissive_color"] = tuple_of(material.emissive_color);
  result["emissive_from_display_color"] = material.emissive_from_display_color;
  result["opacity"] = material.opacity;
  result["opacity_from_display_opacity"] = material.opacity_from_display_opacity;
  result["opacity_threshold"] = material.opacity_threshold;
  result["specular"] = material.specular;
  result["specular_workflow"] = material.specular_workflow;
  result["specular_color"] = tuple_of(material.specular_color);
  result["metallic"] = material.metallic;
  result["roughness"] = material.roughness;
  result["ior"] = material.ior;
  result["clearcoat"] = material.clearcoat;
  result["clearcoat_roughness"] = material.clearcoat_roughness;
  result["transparent_reflects"] = material.transparent_reflects;
  result["normal"] = tuple_of(material.normal);
}

nb::list materials(const SceneHandle& handle) {
  nb::list all;
  for (const Material& material : handle.scene->materials) {
    nb::dict result, driven;
    add_constants(material, result);
    nb::list reads;
    for (const TextureRead& read : material.texture_reads) reads.append(dict_of(read, *handle.scene));
    for (const DrivenInput& input : material.driven)
      driven[kInputs[std::size_t(input.input)]] = dict_of(input, *handle.scene);
    result["texture_reads"] = reads;
    result["driven"] = driven;
    all.append(result);
  }
  return all;
}

nb::list textures(const SceneHandle& handle) {
  nb::list all;
  for (const ImageTexture& texture : handle.scene->textures) {
    nb::dict result;
    nb::list tiles;
    for (const TextureTile& tile : texture.tiles)
      tiles.append(nb::make_tuple(tile.s, tile.t, tile.file.path, tile.file.offset, tile.file.bytes));
    result["name"] = texture.name;
    result["tiles"] = tiles;
    result["udim"] = texture.udim;
    result["wrap"] = nb::make_tuple(kWraps[std::size_t(texture.wrap_s)], kWraps[std::size_t(texture.wrap_t)]);
    result["color_space"] = texture.color_space;
    result["fallback"] = texture.fallback;
    all.append(result);
  }
  return all;
}

// float32[count, 3].
nb::object array_of(const std::vector<Vec3f>& values) {
  auto* copy = new std::vector<Vec3f>(values);
  const nb::capsule owner(copy, [](void* p) noexcept { delete static_cast<std::vector<Vec3f>*>(p); });
  using Values = nb::ndarray<nb::numpy, float, nb::ndim<2>>;
  return nb::cast(Values(&copy->data()->x, {copy->size(), 3}, owner));
}

nb::list primvars(const SceneHandle& handle) {
  const Scene& scene = *handle.scene;
  nb::list all;
  const auto add = [&](const std::string& name, const Appearance& look) {
    nb::dict found;
    for (const SurfacePrimvar& each : look.primvars) {
      const Primvar<Vec3f>& primvar = each.primvar;
      found[name_of(scene, each.name)] = nb::make_tuple(kInterpolations[std::size_t(primvar.interpolation)],
                                                        primvar.segments, array_of(primvar.values));
    }
    all.append(nb::make_tuple(name, found));
  };
  for (const Mesh& mesh : scene.meshes) add(mesh.shape.name, mesh);
  for (const Grids& grids : scene.grids) add(grids.shape.name, grids);
  for (const Curves& curves : scene.curves) add(curves.shape.name, curves);
  for (const Points& points : scene.points) add(points.shape.name, points);
  return all;
}

nb::list instance_primvars(const SceneHandle& handle) {
  nb::list all;
  for (const InstanceSet& set : handle.scene->instances) {
    nb::dict found;
    for (const InstancePrimvar& each : set.primvars)
      found[name_of(*handle.scene, each.name)] = array_of(each.values);
    if (!set.display_opacity.empty()) found["displayOpacity"] = nb::cast(set.display_opacity);
    all.append(nb::make_tuple(set.name, found));
  }
  return all;
}

}  // namespace

void bind_scene_look(nb::class_<SceneHandle>& scene) {
  scene.def_prop_ro("materials", &materials)
      .def_prop_ro("textures", &textures)
      .def_prop_ro("primvars", &primvars)
      .def_prop_ro("instance_primvars", &instance_primvars);
}

}  // namespace msbvh::python
