#include "delegate/translate/frame/motion_scale.h"

#include <cmath>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {

double checked_scale(const ScaleSource& source, double found, double inherited,
                     std::vector<Diagnostic>& diagnostics) {
  if (std::isfinite(found) && found >= source.least) return found;
  const std::string expected = source.least == 0.0 ? "a finite number of at least 0" : "a finite number";
  diagnostics.push_back(
      {Severity::kWarning, source.path, source.attribute,
       message("found ", text(found), ", expected ", expected, "; took ", text(inherited))});
  return inherited;
}

}  // namespace msbvh::translate
