// When rays go down the tree as packets: where they look about the same way, as long as that pays.

#if defined(MSBVH_PACKETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_PACKETS_INL_H
#undef MSBVH_PACKETS_INL_H
#else
#define MSBVH_PACKETS_INL_H
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/trace/packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

// Rays that look about the same way. Where they do not, the first two mostly tell.
inline bool coherent(const Ray* rays) {
  constexpr float kCosine = 0.95f;
  const Vec3f& d = rays[0].dir;
  const float least = kCosine * kCosine * dot(d, d);
  for (std::uint32_t i = kPacket - 1; i > 0; --i) {
    const float along = dot(d, rays[i].dir);
    if (!(along > 0.0f && along * along >= least * dot(rays[i].dir, rays[i].dir))) return false;
  }
  return true;
}

// Coherent rays by packets as long as that pays. One a thread for each kind: large, and it remembers whether
// it did.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit>
class Packets {
 public:
  // kPacket rays; `finish(i, query)` takes the answers.
  template <typename Finish>
  void trace(const Bvh& bvh, const Ray* rays, const Finish& finish) {
    Query queries[kPacket];
    for (std::uint32_t i = 0; i < kPacket; ++i) {
      queries[i].tfar = rays[i].tfar;
      packet_.setup.set(i, rays[i], bvh);
    }
    packet_.setup.join();
    packet_.run(bvh, rays, queries);
    for (std::uint32_t i = 0; i < kPacket; ++i) finish(i, queries[i]);
    packet_.saved -= kSetup;
    if (++traced_ < kTrial || packet_.saved > 0) return;
    passed_over_ = kPause;
    forget();
  }

  // How many of `count` packets to pass over, since the last ones did not pay in this tree.
  std::size_t pass_over(const Bvh& bvh, std::size_t count) {
    if (tree_ != &bvh) passed_over_ = 0;
    tree_ = &bvh;
    const std::size_t n = std::min(count, passed_over_);
    passed_over_ -= n;
    return n;
  }
  bool pays() const { return passed_over_ == 0; }
  // What was saved is not set against what comes next.
  void forget() { traced_ = 0, packet_.saved = 0; }

 private:
  static constexpr std::size_t kTrial = 4, kPause = 124;
  static constexpr std::int64_t kSetup = 60;  // as of Packet::saved

  Packet<kMovement, kKinds, kMixed, kAnyHit> packet_;
  const Bvh* tree_ = nullptr;  // to tell it from others only
  std::size_t traced_ = 0, passed_over_ = 0;
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
