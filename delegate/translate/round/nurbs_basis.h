// NURBS curves as chains of cubic Bezier spans: one between two knots where the curve is a polynomial of
// degree 3 or less, which that is, else several that meet its place and slope at their ends. As long as
// weights hold, Bezier vertices are fixed mixes of the control points, as with other curves.
#pragma once

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/round/curve_basis.h"
#include "delegate/translate/round/left_out.h"

namespace msbvh::translate {

// Adds the curves of a topology whose vertex counts have been checked. False, with an error in the log, where
// arrays do not have the sizes that they need.
bool add_nurbs(const CurveTopology& topology, LeftOut& left_out, CurveBasis& out, PrimLog& log);

}  // namespace msbvh::translate
