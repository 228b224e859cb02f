# Targets of ./run lint, which checks with clang-tidy (preset lint). Nearly all of its time goes into the headers of the
# standard library, Eigen and Boost, once for every unit: therefore many targets are checked as one unit. A unit is
# checked again when a file that it includes changes, as in a compilation.
#
#   lint           all files of the project's targets
#   lint_changed   files in TOPOGEO_LINT_CHANGED; a header is replaced by its source, if any
#
# A unit is divided where its sources repeat names of anonymous namespaces (topogeo_divide()).

set(TOPOGEO_LINT_CHANGED "" CACHE STRING "Files that the target lint_changed checks, relative to the source folder")

# Units, each with a regular expression for the folders of its sources: the first match counts.
set(TOPOGEO_LINT_UNITS
  foundation  "^libs/(geometry|scan|support|voronoi|topomap|matching|calibration|slam|relocalization|session|search_pool)(/|$)"
  libraries   "^libs/"
  research_tests "^research/(tests|bench)"
  research    "^research"
  services    "^services/"
  localizing  "^tests/unit/(geometry|scan|support|voronoi|topomap|localization|search_pool|pipeline)(/|$)"
  units       "^tests/unit/"
  integration "^tests/(container|integration|faults|fuzz|sanitizers)"
  bench       "^tests/bench")

# Call this when all targets exist. Generated files and files outside the units are skipped.
function(topogeo_add_lint)
  find_program(CLANG_TIDY clang-tidy REQUIRED)
  get_property(targets GLOBAL PROPERTY TOPOGEO_TARGETS)
  list(REMOVE_DUPLICATES targets)
  foreach(target IN LISTS targets)
    get_target_property(folder ${target} SOURCE_DIR)
    get_target_property(sources ${target} SOURCES)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE below)
    topogeo_find_lint_unit(${below} unit)
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
      cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${source} generated)
      if(unit AND NOT generated AND source MATCHES "\\.cpp$")
        # A source that several targets share is checked in the unit of its folder.
        cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE name)
        topogeo_find_lint_unit(${name} home)
        list(APPEND sources_of_${home} ${source})
        list(APPEND targets_of_${home} ${target})
      endif()
    endforeach()
  endforeach()

  set(all_sources "")
  set(stamps "")
  set(changed_stamps "")
  list(LENGTH TOPOGEO_LINT_UNITS last)
  math(EXPR last "${last} - 1")
  foreach(i RANGE 0 ${last} 2)
    list(GET TOPOGEO_LINT_UNITS ${i} unit)
    if(sources_of_${unit})
      list(REMOVE_DUPLICATES sources_of_${unit})
      list(REMOVE_DUPLICATES targets_of_${unit})
      list(APPEND all_sources ${sources_of_${unit}})
      topogeo_add_lint_units(${unit} stamps "${targets_of_${unit}}" ${sources_of_${unit}})
    endif()
  endforeach()
  foreach(file IN LISTS TOPOGEO_LINT_CHANGED)
    topogeo_find_lint_unit(${file} unit)
    if(NOT unit)
      continue()
    endif()
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    cmake_path(GET file STEM stem)
    if(file MATCHES "\\.hpp$")
      set(same ${all_sources})
      list(FILTER same INCLUDE REGEX "/${stem}\\.cpp$")
      if(same)
        list(GET same 0 file)
      endif()
    endif()
    list(APPEND changed_of_${unit} ${file})
  endforeach()
  foreach(i RANGE 0 ${last} 2)
    list(GET TOPOGEO_LINT_UNITS ${i} unit)
    if(changed_of_${unit})
      list(REMOVE_DUPLICATES changed_of_${unit})
      topogeo_add_lint_units(changed_${unit} changed_stamps "${targets_of_${unit}}" ${changed_of_${unit}})
    endif()
  endforeach()
  add_custom_target(lint DEPENDS ${stamps})
  add_custom_target(lint_changed DEPENDS ${changed_stamps})

  # A source without a target would be neither compiled nor checked.
  list(JOIN all_sources "\n" listing)
  string(REPLACE "${PROJECT_SOURCE_DIR}/" "" listing "${listing}")
  file(WRITE ${PROJECT_BINARY_DIR}/lint/sources.txt "${listing}\n")
endfunction()

function(topogeo_find_lint_unit path result)
  set(${result} "" PARENT_SCOPE)
  list(LENGTH TOPOGEO_LINT_UNITS last)
  math(EXPR last "${last} - 1")
  foreach(i RANGE 0 ${last} 2)
    math(EXPR j "${i} + 1")
    list(GET TOPOGEO_LINT_UNITS ${i} unit)
    list(GET TOPOGEO_LINT_UNITS ${j} pattern)
    if("${path}" MATCHES "${pattern}")
      set(${result} ${unit} PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# Adds the check of sources, in as few units as their names allow, and appends the stamps to the list named `result`.
function(topogeo_add_lint_units name result targets)
  set(lines "")
  foreach(source IN LISTS ARGN)
    string(APPEND lines "${name}\t0\t${source}\n")
  endforeach()
  topogeo_divide("${lines}" divided lint_${name})
  set(last 0)
  foreach(line IN LISTS divided)
    string(REPLACE "\t" ";" line "${line}")
    list(GET line 1 unit)
    list(GET line 2 source)
    list(APPEND sources_${unit} ${source})
    if(unit GREATER last)
      set(last ${unit})
    endif()
  endforeach()
  set(stamps ${${result}})
  foreach(unit RANGE ${last})
    set(suffix "")
    if(unit GREATER 0)
      set(suffix _${unit})
    endif()
    topogeo_add_lint_unit(${name}${suffix} stamps "${targets}" ${sources_${unit}})
  endforeach()
  set(${result} ${stamps} PARENT_SCOPE)
endfunction()

# Adds the check of sources as one unit, compiled like the targets, and appends its stamp to the list named `result`.
function(topogeo_add_lint_unit name result targets)
  set(file ${PROJECT_BINARY_DIR}/lint/${name}.cpp)
  set(stamp ${PROJECT_BINARY_DIR}/lint/${name}.stamp)
  set(content "")
  set(count 0)
  set(own_includes "")
  foreach(source IN LISTS ARGN)
    # Renamed, because each program has a main() and each fuzzer its entry points.
    string(APPEND content "#define main main_${count}\n#define LLVMFuzzerTestOneInput fuzz_${count}\n#define LLVMFuzzerInitialize fuzz_start_${count}\n"
                          "#include \"${source}\"\n#undef main\n#undef LLVMFuzzerTestOneInput\n#undef LLVMFuzzerInitialize\n")
    math(EXPR count "${count} + 1")
    # A header alone, of a library without sources, is not in the include directories of the unit's targets.
    if(source MATCHES "^(.*/include)/.*\\.hpp$")
      list(APPEND own_includes ${CMAKE_MATCH_1})
    endif()
  endforeach()
  file(CONFIGURE OUTPUT ${file} CONTENT "${content}" @ONLY)

  # Puts the unit's command into compile_commands.json; produces no object.
  add_library(lint_${name} OBJECT EXCLUDE_FROM_ALL ${file})
  set(precompiled topogeo_precompiled)
  if(name MATCHES "localizing|units|integration|bench|research_tests")
    set(precompiled topogeo_precompiled_tests)
  endif()
  target_precompile_headers(lint_${name} REUSE_FROM ${precompiled})
  target_include_directories(lint_${name} PRIVATE ${own_includes})
  target_compile_options(lint_${name} PRIVATE -Wall -Wextra -Wconversion -Wshadow -ffp-contract=off)
  foreach(target IN LISTS targets)
    foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS LINK_LIBRARIES)
      get_target_property(${property} ${target} ${property})
      if(NOT ${property})
        set(${property} "")
      endif()
    endforeach()
    target_include_directories(lint_${name} PRIVATE ${INCLUDE_DIRECTORIES})
    target_compile_definitions(lint_${name} PRIVATE ${COMPILE_DEFINITIONS})
    target_link_libraries(lint_${name} PRIVATE ${LINK_LIBRARIES})
  endforeach()

  set(includes "-I$<JOIN:$<TARGET_PROPERTY:lint_${name},INCLUDE_DIRECTORIES>,;-I>")
  set(definitions "-D$<JOIN:$<TARGET_PROPERTY:lint_${name},COMPILE_DEFINITIONS>,;-D>")
  add_custom_command(OUTPUT ${stamp}
    COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -M -MT ${stamp} -MF ${stamp}.d "${includes}" "${definitions}" ${file}
    COMMAND ${CMAKE_COMMAND} -D TIDY=${CLANG_TIDY} -D BUILD=${PROJECT_BINARY_DIR} -D UNIT=${file}
            -D FOLDER=${PROJECT_SOURCE_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/RunClangTidy.cmake
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${file} ${PROJECT_SOURCE_DIR}/.clang-tidy ${PROJECT_SOURCE_DIR}/cmake/RunClangTidy.cmake
            $<TARGET_OBJECTS:${precompiled}>
    DEPFILE ${stamp}.d
    COMMENT "clang-tidy: ${name}"
    COMMAND_EXPAND_LISTS VERBATIM)
  set(${result} ${${result}} ${stamp} PARENT_SCOPE)
endfunction()
