// Curves of a prim that cannot be drawn: one warning tells of all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

class LeftOut {
 public:
  // `why` goes on after "curve N ".
  void add(std::uint32_t curve, std::string why, std::string attribute = "curveVertexCounts") {
    if (count_++ > 0) return;
    first_ = curve;
    why_ = std::move(why);
    attribute_ = std::move(attribute);
  }
  void report(std::size_t curves, PrimLog& log) const {
    if (count_ > 0)
      log.warn(attribute_,
               message(count_, " of ", curves, " curves are not drawn: curve ", first_, " ", why_));
  }

 private:
  std::size_t count_ = 0;
  std::uint32_t first_ = 0;
  std::string why_, attribute_;
};

}  // namespace msbvh::translate
