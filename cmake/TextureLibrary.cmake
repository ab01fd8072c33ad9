# OpenImageIO, for core/texture: target OpenImageIO::OpenImageIO, and MSBVH_HAS_TEXTURES where there is one.
#
# 1. One that is installed, with its own CMake package; not for the Python extension, which shares a process with the
#    module of PyPI's wheel: there must be one copy.
# 2. The library in PyPI's wheel, of the Python that builds, with the headers of PyPI's source archive of that version,
#    which fetch_openimageio_headers.py gets.
set(MSBVH_TEXTURES AUTO CACHE STRING "Read image textures by OpenImageIO: ON, OFF, or AUTO: where one is found")
set_property(CACHE MSBVH_TEXTURES PROPERTY STRINGS AUTO ON OFF)
set(MSBVH_HAS_TEXTURES OFF)
set(MSBVH_OPENIMAGEIO_FOLDER "")

# In a checkout the Python of `make setup`, unless scikit-build-core names its own.
function(msbvh_building_python result)
  if(MSBVH_BUILD_PYTHON OR NOT EXISTS ${PROJECT_SOURCE_DIR}/.venv/bin/python)
    find_package(Python 3.11 QUIET COMPONENTS Interpreter)
    set(${result} "${Python_EXECUTABLE}" PARENT_SCOPE)
  else()
    set(${result} ${PROJECT_SOURCE_DIR}/.venv/bin/python PARENT_SCOPE)
  endif()
endfunction()

# Sets msbvh_textures_missing to what is missing; empty: nothing is.
function(msbvh_find_openimageio_wheel)
  set(msbvh_textures_missing "a Python 3.11 with the module OpenImageIO" PARENT_SCOPE)
  msbvh_building_python(python)
  if(NOT python)
    return()
  endif()
  execute_process(COMMAND ${python} -c "import importlib.metadata as m, importlib.util as u, os
print(m.version('OpenImageIO'), os.path.dirname(u.find_spec('OpenImageIO').origin), sep=';')"
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    return()
  endif()
  list(GET found 0 version)
  list(GET found 1 module)
  file(GLOB library ${module}/lib/libOpenImageIO.so.*)
  file(GLOB util ${module}/lib/libOpenImageIO_Util.so.*)
  set(headers ${PROJECT_SOURCE_DIR}/build/openimageio-${version})
  if(NOT EXISTS ${headers}/OpenImageIO/oiioversion.h)
    execute_process(COMMAND ${python} ${PROJECT_SOURCE_DIR}/cmake/fetch_openimageio_headers.py ${version} ${headers}
      ERROR_VARIABLE said OUTPUT_VARIABLE said RESULT_VARIABLE failed)
    if(failed)
      string(STRIP "${said}" said)
      set(msbvh_textures_missing "the headers of OpenImageIO ${version} (${said})" PARENT_SCOPE)
      return()
    endif()
  endif()
  find_path(MSBVH_FMT_INCLUDE_DIR fmt/format.h)
  mark_as_advanced(MSBVH_FMT_INCLUDE_DIR)
  if(NOT MSBVH_FMT_INCLUDE_DIR)
    set(msbvh_textures_missing "fmt's headers (libfmt-dev)" PARENT_SCOPE)
    return()
  endif()
  add_library(OpenImageIO::OpenImageIO_Util SHARED IMPORTED GLOBAL)
  set_target_properties(OpenImageIO::OpenImageIO_Util PROPERTIES IMPORTED_LOCATION ${util})
  add_library(OpenImageIO::OpenImageIO SHARED IMPORTED GLOBAL)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION ${library}
    INTERFACE_INCLUDE_DIRECTORIES "${headers};${MSBVH_FMT_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES OpenImageIO::OpenImageIO_Util)
  set(msbvh_textures_missing "" PARENT_SCOPE)
  set(MSBVH_OPENIMAGEIO_FOLDER ${module}/lib PARENT_SCOPE)
  set(MSBVH_OPENIMAGEIO_LIBRARY ${library} PARENT_SCOPE)
  set(MSBVH_OPENIMAGEIO_UTIL_LIBRARY ${util} PARENT_SCOPE)
  message(STATUS "Textures: OpenImageIO ${version}, ${library}")
endfunction()

# The wheel's library is not built for ThreadSanitizer, so that all it does looks like a race.
if(MSBVH_SANITIZE MATCHES thread AND MSBVH_TEXTURES STREQUAL AUTO)
  message(STATUS "Textures are left out: ThreadSanitizer")
elseif(MSBVH_TEXTURES)
  if(NOT MSBVH_BUILD_PYTHON)
    find_package(OpenImageIO 3.0 CONFIG QUIET)
  endif()
  if(TARGET OpenImageIO::OpenImageIO)
    message(STATUS "Textures: OpenImageIO ${OpenImageIO_VERSION}, ${OpenImageIO_DIR}")
  else()
    msbvh_find_openimageio_wheel()
  endif()
  if(TARGET OpenImageIO::OpenImageIO)
    set(MSBVH_HAS_TEXTURES ON)
  elseif(MSBVH_TEXTURES STREQUAL AUTO)
    message(STATUS "Textures are left out: found no OpenImageIO >= 3.0, nor ${msbvh_textures_missing}")
  else()
    message(FATAL_ERROR "Textures: found no OpenImageIO >= 3.0, nor ${msbvh_textures_missing}; -DMSBVH_TEXTURES=OFF builds without")
  endif()
endif()
