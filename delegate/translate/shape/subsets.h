// GeomSubsets: parts of a mesh that have materials of their own.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// A subset, as a front-end has looked it up at a time. Its indices are held from one sample to the next.
struct FaceSubset {
  std::string path;              // of its prim, for messages
  std::span<const int> indices;  // of faces, in any order
};

// Whether a subset's faces may have a material of their own, by its elementType (none: the schema's "face")
// and its familyName.
bool binds_faces(std::string_view element_type, std::string_view family_name);

// The number of the subset that each face of a mesh belongs to, -1 for none. A face of several belongs to the
// last one, with a warning at that one; indices of no face are left out, with another.
std::vector<int> face_owners(std::span<const FaceSubset> subsets, std::size_t face_count,
                             std::vector<Diagnostic>& diagnostics);

// The material of each face, negative for none: the one that its subset is bound to, or the mesh's own where
// no subset has it. `owners` are face_owners().
std::vector<int> face_materials(std::span<const int> owners, std::span<const int> materials_of_subsets,
                                int own_material);

}  // namespace msbvh::translate
