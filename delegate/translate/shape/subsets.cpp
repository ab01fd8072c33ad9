#include "delegate/translate/shape/subsets.h"

#include <cstdint>

namespace msbvh::translate {

bool binds_faces(std::string_view element_type, std::string_view family_name) {
  return (element_type.empty() || element_type == "face") && family_name == "materialBind";
}

std::vector<int> face_owners(std::span<const FaceSubset> subsets, std::size_t face_count,
                             std::vector<Diagnostic>& diagnostics) {
  std::vector<int> owners(face_count, -1);
  for (int number = 0; number < int(subsets.size()); ++number) {
    const FaceSubset& subset = subsets[std::size_t(number)];
    std::size_t outside = 0, taken = 0;
    for (const int face : subset.indices) {
      if (face < 0 || std::size_t(face) >= face_count) {
        ++outside;
        continue;
      }
      int& owner = owners[std::size_t(face)];
      taken += owner >= 0 && owner != number;  // A subset may name a face twice.
      owner = number;
    }
    PrimLog log(diagnostics, subset.path);
    if (outside > 0) {
      log.warn("indices", message("found ", outside, " indices outside 0 to ", std::int64_t(face_count) - 1,
                                  "; left out"));
    }
    if (taken > 0) {
      log.warn("indices",
               message("found ", taken, " faces that an earlier subset has too, expected each face in one",
                       " subset; took this one's material"));
    }
  }
  return owners;
}

std::vector<int> face_materials(std::span<const int> owners, std::span<const int> materials_of_subsets,
                                int own_material) {
  std::vector<int> materials;
  materials.reserve(owners.size());
  for (const int owner : owners) {
    materials.push_back(owner < 0 ? own_material : materials_of_subsets[std::size_t(owner)]);
  }
  return materials;
}

}  // namespace msbvh::translate
