# -DMSBVH_OMIT_EFFECTS="lens;opacity": effects whose code is not compiled, by their names with hyphens for spaces. A scene
# that asks for one is an error. For docs/make_ablation.py, which proves that an effect which is off costs nothing.
set(MSBVH_OMIT_EFFECTS "" CACHE STRING "Effects whose code is left out, for measurements: names of `msbvh plan`, with hyphens")

# In the order of core/plan/effect_set.h.
set(msbvh_effects deforming-keys instances moving-instances camera-motion moving-lights opacity area-lights dome-light
  indirect-light lens polynomial-motion time-remaps aovs curves points displacement subdivision specular textures
  light-controls image-dome refraction fibre)

set(msbvh_known_effects 0)
foreach(effect ${msbvh_effects})
  if(NOT effect IN_LIST MSBVH_OMIT_EFFECTS)
    list(FIND msbvh_effects ${effect} bit)
    math(EXPR msbvh_known_effects "${msbvh_known_effects} | (1 << ${bit})" OUTPUT_FORMAT HEXADECIMAL)
  endif()
endforeach()
foreach(effect ${MSBVH_OMIT_EFFECTS})
  if(NOT effect IN_LIST msbvh_effects AND NOT effect STREQUAL stage-marks)
    list(JOIN msbvh_effects ", " known)
    message(FATAL_ERROR "MSBVH_OMIT_EFFECTS: found ${effect}; expected some of ${known}, stage-marks")
  endif()
endforeach()
if(msbvh_known_effects EQUAL 0)
  message(FATAL_ERROR "MSBVH_OMIT_EFFECTS: found all effects; expected some to be left")
endif()

# true or false: whether no effect of these is left out.
function(msbvh_known result)
  set(${result} true PARENT_SCOPE)
  foreach(effect ${ARGN})
    if(effect IN_LIST MSBVH_OMIT_EFFECTS)
      set(${result} false PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

msbvh_known(msbvh_known_stage_marks stage-marks)
msbvh_known(msbvh_known_time_remaps time-remaps)
# Trees of moving instances move, as those of deforming geometry do.
set(msbvh_known_linear_motion true)
if("deforming-keys" IN_LIST MSBVH_OMIT_EFFECTS AND "moving-instances" IN_LIST MSBVH_OMIT_EFFECTS)
  set(msbvh_known_linear_motion false)
endif()
msbvh_known(msbvh_known_polynomial_motion polynomial-motion)

set(msbvh_omitted_kinds "")
foreach(pair "instances kInstances" "displacement kGrids" "curves kCurves" "points kPoints")
  string(REPLACE " " ";" pair "${pair}")
  list(GET pair 0 effect)
  list(GET pair 1 kind)
  if(effect IN_LIST MSBVH_OMIT_EFFECTS)
    list(APPEND msbvh_omitted_kinds "LeafKind::${kind}")
  endif()
endforeach()
list(JOIN msbvh_omitted_kinds ", " msbvh_omitted_kinds)

set(msbvh_generated ${PROJECT_BINARY_DIR}/generated)
configure_file(${PROJECT_SOURCE_DIR}/core/plan/known_effects.h.in ${msbvh_generated}/core/plan/known_effects.h @ONLY)
configure_file(${PROJECT_SOURCE_DIR}/core/bvh/known_kinds.h.in ${msbvh_generated}/core/bvh/known_kinds.h @ONLY)
