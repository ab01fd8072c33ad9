// GeomSubsets: which faces they have, which of them wins, and what is said of bad indices.
#include <doctest/doctest.h>
#include <limits>
#include <numeric>

#include "delegate/translate/shape/subsets.h"

using namespace msbvh::translate;

namespace {

using Faces = std::vector<int>;

// Subsets /0, /1 and so on of a mesh.
struct Owned {
  Owned(const std::vector<Faces>& given, std::size_t face_count) {
    std::vector<FaceSubset> subsets;
    for (const Faces& faces : given) subsets.push_back({message("/", subsets.size()), faces});
    owners = face_owners(subsets, face_count, diagnostics);
  }
  // "path.attribute: message" of each warning.
  std::vector<std::string> warnings() const {
    std::vector<std::string> lines;
    for (const Diagnostic& d : diagnostics) {
      CHECK(d.severity == Severity::kWarning);
      lines.push_back(d.path + "." + d.attribute + ": " + d.message);
    }
    return lines;
  }

  Faces owners;
  std::vector<Diagnostic> diagnostics;
};

std::string shared(const char* path, const char* count) {
  return std::string(path) + ".indices: found " + count +
         " faces that an earlier subset has too, expected each face in one subset; took this one's material";
}

}  // namespace

TEST_SUITE("translate: subsets") {
  TEST_CASE("a face belongs to the subset that names it, in any order, or to none") {
    const Owned owned({{4, 0}, {}, {3, 1}}, 6);
    CHECK(owned.owners == Faces{0, 2, -1, 2, 0, -1});
    CHECK(owned.diagnostics.empty());
  }

  TEST_CASE("a face of several subsets belongs to the last one, and each later one is named") {
    const Owned owned({{0, 1, 2}, {2, 1, 3}, {3, 2}}, 5);
    CHECK(owned.owners == Faces{0, 1, 2, 2, -1});
    CHECK(owned.warnings() == std::vector{shared("/1", "2"), shared("/2", "2")});
  }

  TEST_CASE("a face that a subset names twice is no overlap, and counts once in one") {
    CHECK(Owned({{1, 1, 0, 1}}, 2).diagnostics.empty());
    const Owned owned({{0, 0}, {0, 1, 0, 0}}, 2);
    CHECK(owned.owners == Faces{1, 1});
    CHECK(owned.warnings() == std::vector{shared("/1", "1")});
  }

  TEST_CASE("indices of no face are left out, each of them counted") {
    constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
    const Owned owned({{-1, 2, 3, kLeast}, {kMost, 0}, {0, -2}}, 3);
    CHECK(owned.owners == Faces{2, -1, 0});
    const std::vector<std::string> expected{"/0.indices: found 3 indices outside 0 to 2; left out",
                                            "/1.indices: found 1 indices outside 0 to 2; left out",
                                            "/2.indices: found 1 indices outside 0 to 2; left out",
                                            shared("/2", "1")};
    CHECK(owned.warnings() == expected);
  }

  TEST_CASE("numbers of faces stand in full however many there are") {
    Faces all(1500000);
    std::iota(all.begin(), all.end(), 0);
    CHECK(Owned({all, all}, all.size()).warnings() == std::vector{shared("/1", "1500000")});
  }

  TEST_CASE("without subsets, or without faces, nothing belongs to anything") {
    CHECK(Owned({}, 2).owners == Faces{-1, -1});
    const Owned empty({{0}}, 0);
    CHECK(empty.owners.empty());
    CHECK(empty.warnings() ==
          std::vector<std::string>{"/0.indices: found 1 indices outside 0 to -1; left out"});
  }

  TEST_CASE("faces have their subset's material, or the mesh's own, or none") {
    const Faces owners{0, -1, 1, 0};
    CHECK(face_materials(owners, Faces{7, -1}, 3) == Faces{7, 3, -1, 7});
    CHECK(face_materials(owners, Faces{7, 8}, -1) == Faces{7, -1, 8, 7});
    CHECK(face_materials({}, {}, 3).empty());
  }

  TEST_CASE("subsets of faces in the family materialBind have materials") {
    CHECK(binds_faces("face", "materialBind"));
    CHECK(binds_faces("", "materialBind"));  // The schema's own element type.
    CHECK(!binds_faces("point", "materialBind"));
    CHECK(!binds_faces("face", "crease"));
    CHECK(!binds_faces("face", ""));
  }
}
