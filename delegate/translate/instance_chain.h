// Where instances are at any time: the product of levels of instancing, computed for one instance and one
// instant after the other, so that a million of them need no samples in memory.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/time_layout.h"

namespace msbvh::translate {

// The maps of one level at one instant; thread-safe.
class LevelInstant {
 public:
  virtual ~LevelInstant() = default;
  virtual Affine3d map(std::size_t index) const = 0;
};

// Which attribute puts an instance nowhere, and what was found there.
struct Blame {
  std::string attribute, found;
  std::string path{};  // of the level's prim; empty: the instances' own
};

// A level of instancing over the shutter.
class ChainLevel {
 public:
  virtual ~ChainLevel() = default;
  virtual std::size_t count() const = 0;
  virtual bool is_still() const = 0;
  virtual std::vector<Breakpoint> breakpoints() const = 0;
  // Increasing times of the shutter between which nothing turns by more than an eighth of a turn.
  virtual std::vector<double> dense_times01() const = 0;
  virtual bool has_dense_times() const = 0;  // cheaper than asking for them
  // Every how many of dense_times01() are as dense for one of the level's things, which may turn slower than
  // others. A power of two.
  virtual std::size_t dense_stride(std::size_t) const { return 1; }
  // After which the motion of some of its things may repeat, whether is_period() or not.
  virtual std::vector<double> periods01() const = 0;
  // `within` is a time on the side of a jump that is meant.
  virtual std::unique_ptr<LevelInstant> at(double time01, double within) const = 0;
  // In words, for reports: which rule says how the level moves.
  virtual std::string rule() const = 0;
  // Of a map that is not finite or too large; nothing where the level does not know.
  virtual std::optional<Blame> blame(std::size_t) const { return std::nullopt; }
};

// More periods than this in one chain are no design but chance (debris that spins): none of them is tried.
inline constexpr std::size_t kMostPeriods = 64;

// Borrows the input's arrays. Null, with an error in the log, for an input that cannot be used.
std::unique_ptr<ChainLevel> make_matrix_level(const InstanceLevel& level, PrimLog& log);
std::unique_ptr<ChainLevel> make_point_level(const InstanceLevel& level, PrimLog& log);

class InstanceChain {
 public:
  // Nothing, with an error in the log, if a level cannot be used.
  static std::optional<InstanceChain> make(const std::vector<InstanceLevel>& levels, PrimLog& log);

  std::size_t count() const { return count_; }
  bool is_still() const;
  std::vector<Breakpoint> breakpoints() const;
  // Of all levels; see ChainLevel.
  std::vector<double> dense_times01() const;
  std::size_t dense_stride(std::size_t instance) const;
  std::vector<double> periods01() const;
  std::string rule() const;
  std::optional<Blame> blame(std::size_t instance) const;

  // All instances at one time.
  class Instant {
   public:
    // Stage space from the innermost space, for the instance whose levels' indices count like digits.
    Affine3d map(std::size_t instance) const;

   private:
    friend class InstanceChain;
    std::vector<std::unique_ptr<LevelInstant>> levels_;  // innermost first
    std::vector<std::size_t> counts_;
  };
  Instant at(double time01, double within) const;

 private:
  InstanceChain() = default;

  std::vector<std::unique_ptr<ChainLevel>> levels_;  // innermost first
  std::size_t count_ = 1;
};

}  // namespace msbvh::translate
