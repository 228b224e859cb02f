# How much longer a test may take here than on the reference machine. No verdict depends on it: limits only end tests
# that hang.
#
#   TOPOGEO_MACHINE_FACTOR    how much slower this machine is, 1 to 20, measured by the first configuration. A busy
#                             machine gets a larger factor, hence longer limits, which is harmless.
#   TOPOGEO_SANITIZER_FACTOR  how much slower programs with a sanitizer are (TopogeoSanitizer.cmake)
#
# Programs get the first one at run time, as TOPOGEO_TIME_FACTOR of the environment: as a compiler option it would
# recompile everything. The second one is compiled in.

# Output of machine_speed.cpp on an idle AMD EPYC core (machine B of docs/results.md), compiled by GCC 12.
set(TOPOGEO_REFERENCE_US 1700)
# Twenty times the longest test on that machine.
set(TOPOGEO_TEST_LIMIT_S 1200)

# Sets TOPOGEO_MACHINE_FACTOR; 1 when programs are for another machine and cannot run here.
function(topogeo_measure_machine)
  if(DEFINED CACHE{TOPOGEO_MACHINE_FACTOR})
    return()
  endif()
  set(factor 1)
  if(NOT CMAKE_CROSSCOMPILING)
    # Optimised and without sanitizers, in every build.
    set(CMAKE_CXX_FLAGS "")
    set(CMAKE_TRY_COMPILE_CONFIGURATION Release)
    try_run(result compiled ${CMAKE_BINARY_DIR}/machine_speed ${PROJECT_SOURCE_DIR}/cmake/machine_speed.cpp
      CXX_STANDARD 20 RUN_OUTPUT_VARIABLE best_us)
    unset(result CACHE)
    unset(compiled CACHE)
    string(STRIP "${best_us}" best_us)
    if(best_us MATCHES "^[0-9]+$")
      # Rounded up, because shell scripts compute with it, but with a tolerance of a quarter for noise.
      math(EXPR factor "(${best_us} + ${TOPOGEO_REFERENCE_US} * 3 / 4 - 1) / ${TOPOGEO_REFERENCE_US}")
    else()
      message(WARNING "machine_speed.cpp does not run here; tests have the limits of the reference machine")
    endif()
    if(factor LESS 1)
      set(factor 1)
    elseif(factor GREATER 20)
      set(factor 20)
    endif()
    message(STATUS "This machine is taken to be ${factor} times slower than the reference (${best_us} us)")
  endif()
  set(TOPOGEO_MACHINE_FACTOR ${factor} CACHE STRING "How much slower than the reference machine this one is, 1 to 20")
endfunction()

topogeo_measure_machine()
math(EXPR TOPOGEO_TEST_LIMIT_S
  "${TOPOGEO_TEST_LIMIT_S} * ${TOPOGEO_MACHINE_FACTOR} * ${TOPOGEO_SANITIZER_FACTOR}")
