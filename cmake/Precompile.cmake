# Headers of the standard library that most sources include are compiled once a target, not once a source: a third of
# what compiling takes, kernels aside. Every source still includes what it uses: with MSBVH_PRECOMPILE=OFF, and by Clang
# for `make fuzz`, they are compiled without.
option(MSBVH_PRECOMPILE "Compile the standard library's headers once a target" ON)

set(msbvh_precompiled <algorithm> <array> <cmath> <cstddef> <cstdint> <functional> <limits> <memory> <numbers> <numeric>
                      <optional> <span> <stdexcept> <string> <string_view> <utility> <vector>)

# HEADERS: more of them, such as those of a test framework.
function(msbvh_precompile target)
  if(MSBVH_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_precompile_headers(${target} PRIVATE ${msbvh_precompiled} ${ARGN})
  endif()
endfunction()
