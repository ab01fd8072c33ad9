// What a front-end may have read of a stage, made of a fuzzer's bytes, with the arrays that it borrows.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "delegate/translate/inputs.h"
#include "delegate/translate/look/surface_look.h"
#include "tests/fuzz/fuzzed_data.h"

namespace msbvh::fuzz {

// Arrays that inputs borrow; none moves once it is here.
struct Arrays {
  std::deque<std::vector<int>> ints{};
  std::deque<std::vector<float>> floats{};
  std::deque<std::vector<double>> doubles{};
  std::deque<std::vector<Vec3f>> points{};
  std::deque<std::vector<translate::Quatf>> quaternions{};
  std::deque<std::vector<translate::Matrix4d>> matrices{};
  std::deque<translate::PointInstancerInput> instancers{};
};

translate::TransformSamples fuzzed_transform(FuzzedData& data);
translate::CameraInput fuzzed_camera_input(FuzzedData& data);
translate::MeshInput fuzzed_mesh_input(FuzzedData& data, Arrays& arrays, std::uint32_t materials);
translate::InstancesInput fuzzed_instances(FuzzedData& data, Arrays& arrays, std::uint32_t prototype,
                                           std::uint32_t materials);
translate::LightInput fuzzed_light_input(FuzzedData& data);
Material fuzzed_material(FuzzedData& data);
// That may read the primvar that fuzzed meshes have, and a texture by it.
translate::SurfaceLook fuzzed_look(FuzzedData& data);

}  // namespace msbvh::fuzz
