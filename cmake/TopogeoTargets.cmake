# Functions for all targets of the project, so that warnings and floating-point rules are the same everywhere.

# Warnings of our own code; errors when TOPOGEO_WERROR is on. -ffp-contract=off: results must not depend on whether a
# compiler fuses multiply and add.
function(topogeo_compile_options target)
  set_property(GLOBAL APPEND PROPERTY TOPOGEO_TARGETS ${target})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow -ffp-contract=off)
  get_target_property(type ${target} TYPE)
  if(TOPOGEO_SANITIZER STREQUAL "thread" AND type STREQUAL "EXECUTABLE")
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/sanitizers/clock_lock.cpp)
  endif()
  if(TOPOGEO_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# For code without hot loops, services and tests: compiles in a quarter to a half less time than with full optimisation,
# but GCC then has false warnings. Used with TOPOGEO_PRECOMPILED_COLD.
function(topogeo_compile_cold target)
  target_compile_options(${target} PRIVATE ${TOPOGEO_COLD_OPTIMIZATION}
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-maybe-uninitialized;-Wno-mismatched-new-delete;-Wno-stringop-overflow>)
endfunction()

# Headers that most files include, parsed once for each set of options: GCC compiles with the optimisation of the
# precompiled header, whatever the command line says. Tests add GoogleMock.
function(topogeo_add_precompiled_headers)
  topogeo_add_precompiled(topogeo_precompiled)
  set(TOPOGEO_PRECOMPILED_COLD topogeo_precompiled PARENT_SCOPE)
  if(TOPOGEO_COLD_OPTIMIZATION)
    topogeo_add_precompiled(topogeo_precompiled_cold)
    topogeo_compile_cold(topogeo_precompiled_cold)
    set(TOPOGEO_PRECOMPILED_COLD topogeo_precompiled_cold PARENT_SCOPE)
  endif()
  if(TOPOGEO_TESTS)
    topogeo_add_precompiled(topogeo_precompiled_tests <gmock/gmock.h> <gtest/gtest.h>)
    target_link_libraries(topogeo_precompiled_tests PRIVATE GTest::gmock)
    topogeo_compile_cold(topogeo_precompiled_tests)
  endif()
endfunction()

# topogeo_add_precompiled(NAME HEADERS...): the common headers and HEADERS.
function(topogeo_add_precompiled name)
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "// Compiled for its precompiled header alone.\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${empty})
  target_link_libraries(${name} PRIVATE Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE
    <algorithm> <array> <chrono> <cmath> <cstdint> <deque> <filesystem> <functional> <limits> <map> <memory>
    <numbers> <numeric> <optional> <span> <sstream> <stdexcept> <string> <string_view> <utility> <vector>
    <Eigen/Core> ${ARGN})
  topogeo_compile_options(${name})
endfunction()

# Speeds up the build of a target: precompiled headers of `precompiled`, and its sources in units of several files
# (presets set how many), by topogeo_divide_targets().
function(topogeo_build_fast target precompiled)
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  # Sources have their own names in messages and databases, but share included headers.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TOPOGEO_UNITY}
                                             UNITY_BUILD_MODE GROUP
                                             UNITY_BUILD_BATCH_SIZE ${TOPOGEO_UNITY_FILES})
  set_property(GLOBAL APPEND PROPERTY TOPOGEO_UNITY_TARGETS ${target})
  # GCC's warning about classes with parts in anonymous namespaces is meant for headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# topogeo_divide(LINES RESULT NAME): divides sources into units in which no name of an anonymous namespace is repeated
# (unity_groups.py); `lines` are `target<TAB>largest<TAB>source`, the result `target<TAB>unit<TAB>source`.
function(topogeo_divide lines result name)
  set(file ${PROJECT_BINARY_DIR}/units/${name})
  file(WRITE ${file}.txt "${lines}")
  execute_process(COMMAND python3 ${PROJECT_SOURCE_DIR}/cmake/unity_groups.py ${file}.txt ${file}.json
    OUTPUT_VARIABLE divided COMMAND_ERROR_IS_FATAL ANY)
  string(STRIP "${divided}" divided)
  string(REPLACE "\n" ";" divided "${divided}")
  set(${result} "${divided}" PARENT_SCOPE)
endfunction()

# Divides the sources of all targets of topogeo_build_fast() into units. Call it when all targets exist.
function(topogeo_divide_targets)
  get_property(targets GLOBAL PROPERTY TOPOGEO_UNITY_TARGETS)
  set(lines "")
  foreach(target IN LISTS targets)
    get_target_property(folder ${target} SOURCE_DIR)
    get_target_property(sources ${target} SOURCES)
    get_target_property(largest ${target} UNITY_BUILD_BATCH_SIZE)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
      string(APPEND lines "${target}\t${largest}\t${source}\n")
    endforeach()
  endforeach()
  topogeo_divide("${lines}" divided targets)
  foreach(line IN LISTS divided)
    string(REPLACE "\t" ";" line "${line}")
    list(GET line 0 target)
    list(GET line 1 unit)
    list(GET line 2 source)
    set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${unit})
  endforeach()
endfunction()

# topogeo_add_library(NAME geometry SOURCES a.cpp ... [DEPENDS targets...] [PRIVATE_DEPENDS targets...] [COLD])
# COLD: see topogeo_compile_cold. Public headers live in include/topogeo/<name>/.
function(topogeo_add_library)
  cmake_parse_arguments(ARG "COLD" "NAME" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  set(target topogeo_${ARG_NAME})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(topogeo::${ARG_NAME} ALIAS ${target})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:include>
                                       PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  topogeo_compile_options(${target})
  if(ARG_COLD)
    topogeo_compile_cold(${target})
    topogeo_build_fast(${target} ${TOPOGEO_PRECOMPILED_COLD})
  else()
    topogeo_build_fast(${target} topogeo_precompiled)
  endif()
endfunction()

# topogeo_use_internals(TARGET matching slam ...): lets a test include the private headers of these libraries.
function(topogeo_use_internals target)
  foreach(lib IN LISTS ARGN)
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/libs/${lib}/src)
  endforeach()
endfunction()

# topogeo_add_service(NAME map_store SOURCES main.cpp ... DEPENDS targets...): an executable in bin/.
function(topogeo_add_service)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_include_directories(${ARG_NAME} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_DEPENDS})
  topogeo_compile_options(${ARG_NAME})
  topogeo_compile_cold(${ARG_NAME})
  topogeo_build_fast(${ARG_NAME} ${TOPOGEO_PRECOMPILED_COLD})
endfunction()

# topogeo_add_test(NAME unit_geometry SOURCES ... DEPENDS targets... [LABELS ...] [PROCESSES]): one test program. Each
# suite in it is one ctest test; with PROCESSES each case is, for programs that start others or join DDS domains.
# TOPOGEO_SHARE names share, TOPOGEO_TEST_DATA tests/data, TOPOGEO_BIN build/bin. Shared helpers are included from
# tests/unit: "localization/simulated_maps.hpp".
function(topogeo_add_test)
  cmake_parse_arguments(ARG "PROCESSES" "NAME" "SOURCES;DEPENDS;LABELS" ${ARGN})
  topogeo_refuse_time_limit(${ARG_NAME} ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  set_target_properties(${ARG_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_include_directories(${ARG_NAME} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests/unit)
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${ARG_NAME} PRIVATE
    TOPOGEO_SHARE="${PROJECT_SOURCE_DIR}/share"
    TOPOGEO_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    TOPOGEO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    TOPOGEO_BIN="${CMAKE_BINARY_DIR}/bin")
  topogeo_compile_options(${ARG_NAME})
  topogeo_compile_cold(${ARG_NAME})
  topogeo_build_fast(${ARG_NAME} topogeo_precompiled_tests)
  if(ARG_PROCESSES)
    gtest_discover_tests(${ARG_NAME} TEST_PREFIX ${ARG_NAME}.
                         PROPERTIES TIMEOUT ${TOPOGEO_TEST_LIMIT_S} LABELS "${ARG_LABELS}"
                                    ENVIRONMENT TOPOGEO_TIME_FACTOR=${TOPOGEO_MACHINE_FACTOR}
                         DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT ${TOPOGEO_TEST_LIMIT_S})
  else()
    topogeo_discover_suites(${ARG_NAME} "${ARG_LABELS}")
  endif()
endfunction()
include(GoogleTest)

# topogeo_add_script_test(container.hosts hosts_test.sh [arguments]): a test with this name is a script of this folder,
# or with a path, that gets the build folder as its first argument. Its label is the part before the dot. The script
# exits with 77, and a message, when the machine lacks something that it needs: skipped.
function(topogeo_add_script_test name script)
  topogeo_refuse_time_limit(${name} ${script})
  cmake_path(ABSOLUTE_PATH script NORMALIZE)
  string(REGEX REPLACE "[.].*" "" label ${name})
  add_test(NAME ${name} COMMAND bash ${script} ${CMAKE_BINARY_DIR} ${ARGN})
  topogeo_set_limit(${name})
  set_tests_properties(${name} PROPERTIES LABELS ${label} SKIP_RETURN_CODE 77)
endfunction()

# topogeo_set_limit(NAME): sets the time limit of all tests (TopogeoTimeFactor.cmake) for a test of add_test(). Its
# TOPOGEO_TIME_FACTOR includes the sanitizer's factor, which scripts do not have compiled in.
function(topogeo_set_limit name)
  math(EXPR factor "${TOPOGEO_MACHINE_FACTOR} * ${TOPOGEO_SANITIZER_FACTOR}")
  set_tests_properties(${name} PROPERTIES TIMEOUT ${TOPOGEO_TEST_LIMIT_S}
    ENVIRONMENT "TOPOGEO_TIME_FACTOR=${factor};TOPOGEO_TEST_NAME=${name}")
endfunction()

# A test with its own limit would pass on one machine and fail on another.
function(topogeo_refuse_time_limit name)
  if("TIMEOUT" IN_LIST ARGN OR "${ARGV1}" MATCHES "^[0-9]+$")
    message(FATAL_ERROR "${name}: tests have no time limits of their own, see cmake/TopogeoTimeFactor.cmake")
  endif()
endfunction()

# Registers each test suite of a program as <program>.<suite>; the list is renewed after each build. Labels and limits
# are added when ctest reads the list: in the command that makes it they would link the program again.
function(topogeo_discover_suites target labels)
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:${target}> -D NAME=${target} -D OUTPUT=${list}
            -P ${PROJECT_SOURCE_DIR}/cmake/ListTestSuites.cmake
    BYPRODUCTS ${list}
    VERBATIM)
  # A program that is not built has no tests, instead of an error for all.
  set(include_file ${CMAKE_CURRENT_BINARY_DIR}/${target}_include.cmake)
  file(CONFIGURE OUTPUT ${include_file} @ONLY CONTENT
"set(suites \"\")
include([==[@list@]==] OPTIONAL)
foreach(suite IN LISTS suites)
  set_tests_properties(@target@.\${suite} PROPERTIES TIMEOUT @TOPOGEO_TEST_LIMIT_S@ LABELS [==[@labels@]==]
    ENVIRONMENT TOPOGEO_TIME_FACTOR=@TOPOGEO_MACHINE_FACTOR@)
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include_file})
endfunction()

# topogeo_set_costs(FILE): makes ctest start tests in the order of their durations in FILE ("seconds name" a line), even
# before their first run. Call it in the folder that is added last, because ctest must know the tests by then. Names of
# missing tests are harmless.
function(topogeo_set_costs file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(STRINGS ${file} lines REGEX "^[^#]")
  set(content "")
  foreach(line IN LISTS lines)
    if(NOT line MATCHES "^([0-9]+) (.+)$")
      message(FATAL_ERROR "${file}: expected a line 'seconds name', got '${line}'")
    endif()
    string(APPEND content "set_tests_properties([==[${CMAKE_MATCH_2}]==] PROPERTIES COST ${CMAKE_MATCH_1})\n")
  endforeach()
  set(include_file ${CMAKE_CURRENT_BINARY_DIR}/costs.cmake)
  file(CONFIGURE OUTPUT ${include_file} CONTENT "${content}" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include_file})
endfunction()
