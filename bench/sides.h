// Those who compete in a run, seen alike: ours once a builder, the peer with its robust flag and without it.
// Each can be asked in several modes: one ray at a time, and many at once.
#pragma once

#include <memory>
#include <optional>
#include <span>
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
  virtual const std::vector<std::string>& modes() const = 0;
  // The rays to trace, in the layout that it takes; outside of the clock. Borrows them.
  virtual void prepare(const std::vector<Ray>& rays) = 0;
  // t of the closest hit or, for shadow rays, 0; infinity where there is none. For the rays begin .. end - 1
  // of those prepared, in modes()[mode].
  virtual void trace(std::size_t mode, RayKind kind, std::size_t begin, std::size_t end, float* t) const = 0;
};

class OurSide : public Side {
 public:
  enum Mode : std::size_t { kSingle, kMany };

  OurSide(std::shared_ptr<const Scene> scene, const BuilderName& builder, TreeLayout layout)
      : builder(builder), layout(layout), scene_(std::move(scene)) {}
  void build(unsigned) override;
  void drop() override {
    tracer_.reset();
    trees_.reset();
  }
  std::uint64_t bytes() const override { return trees_->bytes(); }
  const std::vector<std::string>& modes() const override;
  void prepare(const std::vector<Ray>& rays) override { rays_ = rays; }
  void trace(std::size_t mode, RayKind kind, std::size_t begin, std::size_t end, float* t) const override;
  const Trees& trees() const { return *trees_; }

  const BuilderName builder;
  const TreeLayout layout;

 private:
  void trace_single(RayKind kind, std::span<const Ray> rays, float* t) const;
  void trace_many(RayKind kind, std::span<const Ray> rays, float* t) const;

  std::shared_ptr<const Scene> scene_;
  std::span<const Ray> rays_;
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
  void drop() override {
    rays_.reset();
    peer_.reset();
  }
  std::uint64_t bytes() const override { return peer_->bytes(); }
  const std::vector<std::string>& modes() const override { return library_.modes(); }
  void prepare(const std::vector<Ray>& rays) override { rays_ = peer_->prepare(rays.data(), rays.size()); }
  void trace(std::size_t mode, RayKind kind, std::size_t begin, std::size_t end, float* t) const override {
    kind == RayKind::kShadow ? peer_->occluded(mode, *rays_, begin, end, t)
                             : peer_->intersect(mode, *rays_, begin, end, t);
  }

  const bool robust;

 private:
  const PeerLibrary& library_;
  const PeerScene& scene_;
  std::unique_ptr<Peer> peer_;
  std::unique_ptr<PeerRays> rays_;
};

// All rays that the side was prepared for, one t each, by the threads of the calling arena.
void trace_all(const Side& side, std::size_t mode, RayKind kind, std::vector<float>& t);

}  // namespace msbvh::bench
