#include "core/bvh/verify_round.h"

#include <string>

#include "core/base/error.h"
#include "core/geometry/curve_piece.h"

namespace msbvh {
namespace {

constexpr std::uint32_t kInstantsPerSegment = 8;
constexpr int kPlaces = 16;  // along a piece

[[noreturn]] void fail(const std::string& part, std::uint32_t index, const std::string& what) {
  throw Error("accelerator: " + part + " " + std::to_string(index) + ": " + what);
}

// The ball about `v`, in double as the sums are exact there.
bool holds(const Box3f& box, const Vec3d& p, double radius) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] - radius < double(box.lo[axis]) || p[axis] + radius > double(box.hi[axis])) return false;
  }
  return true;
}

// visit(u) at the keys of both and between them.
template <typename Visit>
void at_instants(const TrackForm& form, const Slot& slot, const TimeSlice& slice, const Visit& visit) {
  const std::uint32_t steps = common_form(form, slot.form).segments * kInstantsPerSegment;
  for (std::uint32_t k = 0; k <= steps; ++k)
    visit(slice.time(steps == 0 ? 0.0f : static_cast<float>(k) / static_cast<float>(steps)));
}

template <typename Set, typename Map>
void check_all(const std::vector<std::shared_ptr<const Set>>& sets, std::uint32_t count_of(const Set&),
               const Map& found, std::uint32_t whole, const char* part) {
  std::size_t expected = 0;
  for (std::uint32_t s = 0; s < sets.size(); ++s) {
    for (std::uint32_t i = 0; i < count_of(*sets[s]); ++i) {
      if (!is_there(*sets[s], i)) continue;
      ++expected;
      const auto at = found.find({s, i});
      if (at == found.end() || at->second != whole)
        fail(part, i, "is not in the leaves once, with all of its pieces");
    }
  }
  if (found.size() != expected)
    throw Error(std::string("accelerator: leaves hold ") + part + "s without width");
}

}  // namespace

void RoundVerifier::add(const BlockHeader& block, const Slot& slot) {
  const Bvh& bvh = bvh_;
  const bool curves = block.kind == BlockKind::kCurves;
  if (block.owner >= (curves ? bvh.curves.size() : bvh.points.size()))
    fail("block of set", block.owner, "there is none");
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const std::uint32_t id = block.triangles()[i];
    if (curves) {
      check_piece(*bvh.curves[block.owner], id, slot);
      const CurvePiece piece = CurvePiece::of(id);
      spans_[{block.owner, piece.span}] += kMaxPieces / piece.parts;
    } else {
      check_point(*bvh.points[block.owner], id, slot);
      ++points_[{block.owner, id}];
    }
  }
}

void RoundVerifier::check_piece(const CurveSet& curves, std::uint32_t code, const Slot& slot) const {
  const CurvePiece piece = CurvePiece::of(code);
  if (piece.span >= curves.span_count()) fail("span", piece.span, "there is none");
  at_instants(curves.form(), slot, slice_, [&](float u) {
    const Box3f box = slot.at(u);
    RoundVertex v[kSpanVertices];
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) v[i] = curves.vertex(curves.spans[piece.span] + i, u);
    for (int k = 0; k <= kPlaces; ++k) {
      const double s = piece.begin() + (double(piece.end()) - piece.begin()) * k / kPlaces;
      const auto p = [&](std::uint32_t i) { return Vec3d(v[i].p); };
      const auto r = [&](std::uint32_t i) { return double(v[i].radius); };
      if (!holds(box, bezier(p, kSpanVertices - 1, s), bezier(r, kSpanVertices - 1, s)))
        fail("span", piece.span, "a piece of it is outside its leaf at u = " + std::to_string(u));
    }
  });
}

void RoundVerifier::check_point(const PointSet& points, std::uint32_t point, const Slot& slot) const {
  if (point >= points.point_count) fail("point", point, "there is none");
  at_instants(points.form(), slot, slice_, [&](float u) {
    const RoundVertex v = points.vertex(point, u);
    if (!holds(slot.at(u), Vec3d(v.p), double(v.radius)))
      fail("point", point, "is outside its leaf at u = " + std::to_string(u));
  });
}

void RoundVerifier::finish() const {
  const Bvh& bvh = bvh_;
  check_all<CurveSet>(
      bvh.curves, [](const CurveSet& c) { return c.span_count(); }, spans_, kMaxPieces, "span");
  check_all<PointSet>(
      bvh.points, [](const PointSet& p) { return p.point_count; }, points_, 1, "point");
}

}  // namespace msbvh
