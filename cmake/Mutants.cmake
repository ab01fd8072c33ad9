# -DMSBVH_MUTANTS=ON: switches for the deliberate defects of tests/mutants.toml, in copies of the sources in the build
# folder that stand before the sources themselves. The environment variable MSBVH_MUTANT names the one that acts.
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
set(msbvh_mutant_sources ${PROJECT_BINARY_DIR}/mutants)
execute_process(COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/switch_mutants.py ${msbvh_mutant_sources}
  OUTPUT_VARIABLE msbvh_switched_sources COMMAND_ERROR_IS_FATAL ANY)
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/tests/mutants.toml ${PROJECT_SOURCE_DIR}/cmake/switch_mutants.py)

# Puts the copies in place of those of a target's sources that have switches.
function(msbvh_switch_sources target)
  target_include_directories(${target} BEFORE PUBLIC $<BUILD_INTERFACE:${msbvh_mutant_sources}>)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${msbvh_switched_sources})
    list(TRANSFORM sources REPLACE "^(${PROJECT_SOURCE_DIR}/)?${source}$" "${msbvh_mutant_sources}/${source}")
  endforeach()
  set_target_properties(${target} PROPERTIES SOURCES "${sources}")
endfunction()
