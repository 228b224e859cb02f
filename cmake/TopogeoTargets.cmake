# Functions that every target of the project goes through, so that warnings and floating-point rules
# are the same everywhere.

# Warnings of our own code; errors when TOPOGEO_WERROR is on.
# -ffp-contract=off: results must not depend on whether a compiler fuses multiply and add.
function(topogeo_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow -ffp-contract=off)
  if(TOPOGEO_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# topogeo_add_library(NAME geometry SOURCES a.cpp ... [DEPENDS targets...] [PRIVATE_DEPENDS targets...])
# Public headers live in include/topogeo/<name>/.
function(topogeo_add_library)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  set(target topogeo_${ARG_NAME})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(topogeo::${ARG_NAME} ALIAS ${target})
  target_include_directories(${target} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/include
                                       PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  topogeo_compile_options(${target})
endfunction()

# topogeo_add_service(NAME map_store SOURCES main.cpp ... DEPENDS targets...): an executable in bin/.
function(topogeo_add_service)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_include_directories(${ARG_NAME} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_DEPENDS})
  topogeo_compile_options(${ARG_NAME})
endfunction()

# topogeo_add_test(NAME unit_geometry SOURCES ... DEPENDS targets... [TIMEOUT s] [LABELS ...]): one test
# program; each TEST in it is one ctest case. TOPOGEO_TEST_DATA names tests/data, TOPOGEO_BIN build/bin.
function(topogeo_add_test)
  cmake_parse_arguments(ARG "" "NAME;TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  set_target_properties(${ARG_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${ARG_NAME} PRIVATE
    TOPOGEO_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    TOPOGEO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    TOPOGEO_BIN="${CMAKE_BINARY_DIR}/bin")
  topogeo_compile_options(${ARG_NAME})
  gtest_discover_tests(${ARG_NAME} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
                       DISCOVERY_MODE PRE_TEST)
endfunction()
include(GoogleTest)
