// Those who compete in a run, seen alike: ours once a builder, the peer once a mode.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/peer_input.h"
#include "bench/peer_library.h"
#include "bench/ray_sets.h"
#include "bench/trees.h"

namespace msbvh::bench {

class Side {
 public:
  virtual ~Side() = default;
  // Frees what was built before. Uses the threads of the calling arena, and no more than `threads` (0: all).
  virtual void build(unsigned threads) = 0;
  virtual void drop() = 0;
  virtual std::uint64_t bytes() const = 0;
  // t of the closest hit or, for shadow rays, 0; infinity where there is none.
  virtual void trace(RayKind kind, const Ray* rays, std::size_t count, float* t) const = 0;
};

class OurSide : public Side {
 public:
  OurSide(std::shared_ptr<const Scene> scene, const BuilderName& builder)
      : builder(builder), scene_(std::move(scene)) {}
  void build(unsigned) override;
  void drop() override {
    tracer_.reset();
    trees_.reset();
  }
  std::uint64_t bytes() const override { return trees_->bytes(); }
  void trace(RayKind kind, const Ray* rays, std::size_t count, float* t) const override;
  const Trees& trees() const { return *trees_; }

  const BuilderName builder;

 private:
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<Trees> trees_;
  std::optional<Tracer> tracer_;  // made once: asking what a virtual machine supports takes microseconds
};

class PeerSide : public Side {
 public:
  PeerSide(const PeerLibrary& library, const PeerScene& scene, bool robust)
      : robust(robust), library_(library), scene_(scene) {}
  void build(unsigned threads) override {
    peer_ = library_.make(scene_, threads, robust);
    peer_->build();
  }
  void drop() override { peer_.reset(); }
  std::uint64_t bytes() const override { return peer_->bytes(); }
  void trace(RayKind kind, const Ray* rays, std::size_t count, float* t) const override {
    kind == RayKind::kShadow ? peer_->occluded(rays, count, t) : peer_->intersect(rays, count, t);
  }

  const bool robust;

 private:
  const PeerLibrary& library_;
  const PeerScene& scene_;
  std::unique_ptr<Peer> peer_;
};

// All rays by the threads of the calling arena.
void trace_all(const Side& side, RayKind kind, const std::vector<Ray>& rays, std::vector<float>& t);

}  // namespace msbvh::bench
