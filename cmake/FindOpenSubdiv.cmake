# OpenSubdiv's CPU half: target OpenSubdiv::osdCPU. A module of our own, since Debian's package ships a CMake package
# that names static libraries which it does not hold, and fails for it. Installed beside msbvh-config.cmake.
find_path(OpenSubdiv_INCLUDE_DIR opensubdiv/bfr/surface.h)
find_library(OpenSubdiv_osdCPU_LIBRARY osdCPU)
if(OpenSubdiv_INCLUDE_DIR AND EXISTS ${OpenSubdiv_INCLUDE_DIR}/opensubdiv/version.h)
  file(STRINGS ${OpenSubdiv_INCLUDE_DIR}/opensubdiv/version.h _opensubdiv_version
       REGEX "#define OPENSUBDIV_VERSION_(MAJOR|MINOR|PATCH) ")
  string(REGEX REPLACE "[^0-9;]" "" OpenSubdiv_VERSION "${_opensubdiv_version}")
  string(REPLACE ";" "." OpenSubdiv_VERSION "${OpenSubdiv_VERSION}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenSubdiv REQUIRED_VARS OpenSubdiv_osdCPU_LIBRARY OpenSubdiv_INCLUDE_DIR
                                  VERSION_VAR OpenSubdiv_VERSION)
if(OpenSubdiv_FOUND AND NOT TARGET OpenSubdiv::osdCPU)
  add_library(OpenSubdiv::osdCPU UNKNOWN IMPORTED)
  # Headers of an imported target are system headers: their warnings are not ours.
  set_target_properties(OpenSubdiv::osdCPU PROPERTIES
    IMPORTED_LOCATION ${OpenSubdiv_osdCPU_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenSubdiv_INCLUDE_DIR})
endif()
mark_as_advanced(OpenSubdiv_INCLUDE_DIR OpenSubdiv_osdCPU_LIBRARY)
