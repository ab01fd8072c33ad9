#include "tests/fuzz/fuzzed_inputs.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace msbvh::fuzz {

using namespace msbvh::translate;

namespace {

std::vector<VisibleInterval> intervals(FuzzedData& data) {
  std::vector<VisibleInterval> shown;
  double at = data.unit() - 0.5;
  for (std::uint32_t n = data.below(4); n > 0; --n) {
    const double end = at + data.unit();
    shown.push_back({at, data.wrong() ? data.real() : end});
    at = end + data.unit() * 0.5;
  }
  return shown;
}

ArraySamples array_samples(FuzzedData& data, Arrays& arrays, std::size_t count) {
  ArraySamples samples;
  samples.held = data.rarely();
  samples.timeless = data.rarely();
  const std::vector<double> times01 = data.times01(data.one_of({1u, 1u, 2u, 2u, 3u, 5u}));
  for (const double time01 : times01) {
    arrays.points.push_back(data.points(data.wrong() ? count + 1 : count));
    samples.samples.push_back({time01, arrays.points.back()});
  }
  if (data.wrong()) samples.samples.clear();
  return samples;
}

template <typename T>
void set_primvar(PrimvarInput<T>& out, FuzzedData& data, std::deque<std::vector<T>>& arrays, Arrays& others,
                 std::size_t count, const std::vector<T>& values) {
  if (data.coin()) return;
  out.interpolation = data.word({"constant", "uniform", "varying", "vertex", "faceVarying"});
  arrays.push_back(values);
  out.values = arrays.back();
  if (data.rarely()) {
    others.ints.push_back(data.ints(count, 0, std::max(0, int(values.size()) - 1)));
    out.indices = others.ints.back();
  }
  if (!data.rarely()) return;
  for (const double time01 : data.times01(1 + data.below(3))) {
    std::vector<T> moved = values;
    if (!moved.empty() && data.coin()) std::swap(moved.front(), moved.back());
    arrays.push_back(moved);
    out.samples.push_back({time01, arrays.back()});
  }
}

RateInput rates(FuzzedData& data, Arrays& arrays, std::size_t count) {
  RateInput out;
  if (!data.rarely()) return out;
  out.velocities = array_samples(data, arrays, count);
  if (data.coin()) out.accelerations = array_samples(data, arrays, count);
  return out;
}

RateTimes rate_times(FuzzedData& data) {
  return {data.time01(), data.coin() ? data.unit() * 0.1 : data.real(), data.rarely() ? data.real32() : 1.0f};
}

// Sheets of quads, or any faces; counts of vertices that the indices ask for.
std::size_t add_faces(MeshInput& mesh, FuzzedData& data, Arrays& arrays) {
  std::vector<int> counts, indices;
  const int columns = int(1 + data.below(4)), rows = int(1 + data.below(3));
  int vertices = (columns + 1) * (rows + 1);
  if (data.coin()) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        const int a = r * (columns + 1) + c, b = a + columns + 1;
        counts.push_back(4);
        indices.insert(indices.end(), {a, a + 1, b + 1, b});
      }
    }
  } else {
    for (std::uint32_t n = data.below(10); n > 0; --n) {
      counts.push_back(int(data.rarely() ? data.below(9) : 3 + data.below(2)));
      const auto corners = data.ints(std::size_t(counts.back()), 0, vertices - 1);
      indices.insert(indices.end(), corners.begin(), corners.end());
    }
  }
  if (data.wrong() && !counts.empty()) counts[0] = data.one_of({0, -1, 1, 2, 2147483647, 5});
  if (data.wrong() && !indices.empty()) indices[0] = data.one_of({-1, vertices, 2147483647});
  if (data.rarely()) {
    arrays.ints.push_back(data.ints(2, 0, std::max(0, int(counts.size()) - 1)));
    mesh.hole_indices = arrays.ints.back();
  }
  arrays.ints.push_back(counts);
  mesh.face_vertex_counts = arrays.ints.back();
  arrays.ints.push_back(indices);
  mesh.face_vertex_indices = arrays.ints.back();
  return std::size_t(vertices);
}

void add_creases(SubdivisionInput& out, FuzzedData& data, Arrays& arrays, std::size_t vertices) {
  out.scheme = data.word({"none", "catmullClark", "loop", "bilinear"});
  if (out.scheme == "none" || !data.rarely()) return;
  out.interpolate_boundary = data.word({"edgeAndCorner", "edgeOnly", "none"});
  out.face_varying_linear =
      data.word({"cornersPlus1", "all", "none", "boundaries", "cornersOnly", "cornersPlus2"});
  out.triangle_rule = data.word({"catmullClark", "smooth"});
  arrays.ints.push_back({3});
  out.crease_lengths = arrays.ints.back();
  arrays.ints.push_back(data.ints(3, 0, int(vertices) - 1));
  out.crease_indices = arrays.ints.back();
  arrays.floats.push_back(data.reals(data.coin() ? 1 : 2, 0.0f, 12.0f));
  out.crease_sharpnesses = arrays.floats.back();
  arrays.ints.push_back(data.ints(2, 0, int(vertices) - 1));
  out.corner_indices = arrays.ints.back();
  arrays.floats.push_back(data.reals(2, 0.0f, 12.0f));
  out.corner_sharpnesses = arrays.floats.back();
}

std::size_t add_round(RoundInput& out, FuzzedData& data, Arrays& arrays) {
  std::size_t points = 0;
  if (data.coin()) {
    out.kind = RoundInput::Kind::kPoints;
    points = data.below(12);
  } else {
    out.kind = RoundInput::Kind::kCurves;
    out.topology.type = data.word({"cubic", "linear", "cubic"});
    out.topology.basis = data.word({"bezier", "bspline", "catmullRom"});
    out.topology.wrap = data.word({"nonperiodic", "periodic", "pinned"});
    arrays.ints.push_back(data.ints(data.below(4), 2, 10));
    out.topology.vertex_counts = arrays.ints.back();
    for (const int count : arrays.ints.back()) points += std::size_t(std::clamp(count, 0, 20));
  }
  set_primvar(out.widths, data, arrays.floats, arrays, points,
              data.reals(data.coin() ? 1 : points, 0.0f, 0.2f));
  return points;
}

void add_looks(MeshInput& mesh, FuzzedData& data, Arrays& arrays, std::size_t points,
               std::uint32_t materials) {
  const std::size_t counts[] = {1, points, mesh.face_vertex_counts.size(), mesh.face_vertex_indices.size()};
  const auto some = [&] { return counts[data.below(4)]; };
  std::vector<Vec3f> colors = data.points(some());
  for (Vec3f& c : colors) {
    if (!data.broken()) c = {std::min(std::abs(c.x), 1.0f), std::min(std::abs(c.y), 1.0f), 0.5f};
  }
  set_primvar(mesh.display_color, data, arrays.points, arrays, points, colors);
  set_primvar(mesh.display_opacity, data, arrays.floats, arrays, points, data.reals(some(), 0.0f, 1.0f));
  if (data.rarely()) {
    mesh.normals = array_samples(data, arrays, some());
    mesh.normals_interpolation = data.word({"vertex", "faceVarying", "uniform", "constant", "varying"});
  }
  mesh.computed_normals = data.coin() ? Normals::kFaceted : Normals::kSmooth;
  if (data.rarely()) {
    NamedPrimvar& named = mesh.named_primvars.emplace_back();
    named.name = "height";
    set_primvar(named.primvar, data, arrays.points, arrays, points, data.points(some()));
  }
  if (materials > 0 && data.coin()) mesh.material = data.below(materials);
  if (materials > 0 && data.rarely()) {
    arrays.ints.push_back(data.ints(mesh.face_vertex_counts.size(), -1, int(materials) - 1));
    mesh.face_materials = arrays.ints.back();
    for (int& material : arrays.ints.back()) material = std::clamp(material, -1, int(materials) - 1);
  }
}

PointInstancerInput* add_instancer(FuzzedData& data, Arrays& arrays, std::size_t count) {
  PointInstancerInput& out = arrays.instancers.emplace_back();
  out.path = data.coin() ? "/instancer" : "";
  out.count = count;
  out.positions = array_samples(data, arrays, count);
  if (data.coin()) out.scales = array_samples(data, arrays, count);
  if (data.coin()) {
    for (const double time01 : data.times01(1 + data.below(3))) {
      std::vector<Quatf>& values = arrays.quaternions.emplace_back();
      for (std::size_t i = 0; i < count; ++i)
        values.push_back({data.real32(), float(data.unit()), 0.0f, float(data.unit())});
      out.orientations.samples.push_back({time01, values});
    }
  }
  out.rates = rates(data, arrays, count);
  if (data.rarely()) out.angular_velocities = array_samples(data, arrays, count);
  out.time_remap = rate_times(data);
  return &out;
}

InstanceLevel fuzzed_level(FuzzedData& data, Arrays& arrays) {
  InstanceLevel level;
  const std::size_t count = data.below(4);
  level.held = data.rarely();
  if (data.coin()) {
    level.points = add_instancer(data, arrays, count);
    std::vector<int>& selected = arrays.ints.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      if (!data.rarely()) selected.push_back(int(i));
    }
    level.selected = selected;
    return level;
  }
  level.times01 = data.times01(data.one_of({1u, 1u, 2u, 3u, 5u}));
  std::vector<Matrix4d>& matrices = arrays.matrices.emplace_back();
  for (std::size_t i = 0; i < level.times01.size() * count; ++i) matrices.push_back(data.matrix());
  level.matrices = matrices;
  return level;
}

}  // namespace

TransformSamples fuzzed_transform(FuzzedData& data) {
  TransformSamples samples;
  samples.times01 = data.times01(data.one_of({1u, 1u, 2u, 3u, 5u, 9u}));
  const Matrix4d first = data.matrix();
  for (std::size_t i = 0; i < samples.times01.size(); ++i)
    samples.matrices.push_back(data.coin() ? first : data.matrix());
  if (data.rarely()) samples.breakpoints01 = data.times01(data.below(4));
  samples.held = data.rarely();
  if (data.rarely()) samples.periods01 = {data.unit()};
  return samples;
}

CameraInput fuzzed_camera_input(FuzzedData& data) {
  CameraInput camera;
  camera.path = "/camera";
  camera.projection = data.rarely() ? Projection::kOrthographic : Projection::kPerspective;
  const std::vector<double> times01 = data.times01(data.one_of({1u, 1u, 1u, 2u, 3u}));
  const bool lens = data.rarely(), clip = data.rarely();
  Matrix4d at{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1};
  if (data.rarely()) at = data.matrix();
  for (const double time01 : times01) {
    CameraSample& sample = camera.samples.emplace_back();
    sample.time01 = time01;
    sample.world_from_camera = data.rarely() ? data.matrix() : at;
    if (data.rarely()) sample.window = {data.real32(), data.real32(), data.real32(), data.real32()};
    if (lens) sample.lens = {float(data.unit()), float(data.positive())};
    if (clip) sample.clip = ClipRange{0.1f, float(data.positive())};
  }
  camera.near_clip = data.rarely() ? data.real32() : 0.1f;
  camera.far_clip = data.rarely() ? data.real32() : 1e6f;
  if (data.rarely()) camera.breakpoints01 = data.times01(2);
  return camera;
}

MeshInput fuzzed_mesh_input(FuzzedData& data, Arrays& arrays, std::uint32_t materials) {
  MeshInput mesh;
  mesh.path = "/mesh";
  std::size_t points = 0;
  if (data.below(4) == 3) {
    points = add_round(mesh.round, data, arrays);
  } else {
    points = add_faces(mesh, data, arrays);
    add_creases(mesh.subdivision, data, arrays, points);
  }
  mesh.left_handed = data.coin();
  mesh.points = array_samples(data, arrays, points);
  mesh.rates = rates(data, arrays, points);
  mesh.time_remap = rate_times(data);
  mesh.topology_varies = data.rarely();
  mesh.computed_points = data.rarely();
  if (data.rarely()) mesh.visible = intervals(data);
  mesh.world_from_object = fuzzed_transform(data);
  mesh.displaced = !data.rarely();
  add_looks(mesh, data, arrays, points, materials);
  return mesh;
}

InstancesInput fuzzed_instances(FuzzedData& data, Arrays& arrays, std::uint32_t prototype,
                                std::uint32_t materials) {
  InstancesInput input;
  input.path = "/instances";
  input.prototype = prototype;
  for (std::uint32_t n = 1 + data.below(2); n > 0; --n) input.levels.push_back(fuzzed_level(data, arrays));
  if (data.rarely()) input.visible = intervals(data);
  std::size_t count = 1;
  for (const InstanceLevel& level : input.levels) {
    count *= level.points ? level.selected.size() : level.matrices.size() / level.times01.size();
  }
  if (data.rarely()) {
    arrays.points.push_back(data.points(data.wrong() ? count + 1 : count));
    input.display_color.values = arrays.points.back();
    input.display_color.interpolation = "vertex";
  }
  if (data.rarely() && materials > 0) {
    arrays.ints.push_back(std::vector<int>(count, int(materials) - 1));
    input.materials = arrays.ints.back();
  }
  return input;
}

LightInput fuzzed_light_input(FuzzedData& data) {
  LightInput input;
  input.light.name = "/light";
  input.light.kind = LightKind(data.below(7));
  const auto values = [&] {
    LightValues v;
    v.radiance = {data.real32(), float(data.unit()), float(data.unit())};
    if (!data.broken()) v.radiance.x = std::abs(v.radiance.x);
    v.radius = data.coin() ? float(data.unit()) : data.real32();
    v.angle_degrees = data.coin() ? float(data.unit()) : data.real32();
    v.width = data.coin() ? 1.0f : data.real32();
    v.height = data.coin() ? 1.0f : data.real32();
    v.length = data.coin() ? 1.0f : data.real32();
    v.cone_angle_degrees = data.coin() ? 180.0f : data.real32();
    v.focus = data.coin() ? 0.0f : data.real32();
    return v;
  };
  static_cast<LightValues&>(input.light) = values();
  input.world_from_light = fuzzed_transform(data);
  if (data.rarely()) {
    input.values_times01 = data.times01(1 + data.below(4));
    for (std::size_t i = 0; i < input.values_times01.size(); ++i) input.values.push_back(values());
    if (data.wrong()) input.values.pop_back();
  }
  return input;
}

Material fuzzed_material(FuzzedData& data) {
  Material material;
  material.name = "/material";
  const auto channel = [&] { return data.rarely() ? data.real32() : float(data.unit()); };
  material.diffuse_color = {channel(), channel(), channel()};
  if (data.rarely()) material.emissive_color = {channel(), channel(), channel()};
  material.diffuse_from_display_color = data.coin();
  material.emissive_from_display_color = data.rarely();
  material.opacity = data.coin() ? 1.0f : channel();
  material.opacity_from_display_opacity = data.coin();
  material.opacity_threshold = data.coin() ? 0.0f : channel();
  return material;
}

SurfaceLook fuzzed_look(FuzzedData& data) {
  SurfaceLook look(fuzzed_material(data));
  if (!data.coin()) return look;
  look.primvars = {{"height", 1}, {"st", 2}};
  look.textures = {{.name = "a.png", .tiles = {{0, 0, {"/a.png"}}}}};
  look.material.driven = {{SurfaceInput::kRoughness, DrivenInput::Source::kPrimvar, data.below(2)},
                          {SurfaceInput::kOpacity, DrivenInput::Source::kTexture, 0, 3}};
  look.material.texture_reads = {{.coordinates = data.coin() ? PrimvarName(data.below(2)) : kNoPrimvar}};
  return look;
}

}  // namespace msbvh::fuzz
