# Compiled-in sanitizers (presets asan and tsan, ./run test --sanitize), and the additional time of tests with them:
# TOPOGEO_SANITIZER_FACTOR, for TopogeoTimeFactor.cmake and as the macro TOPOGEO_TIME_FACTOR for the tests' own limits
# (tests/unit/time_factor.hpp).

set(TOPOGEO_SANITIZER "" CACHE STRING "address (with undefined behaviour), thread, or empty for none")
set_property(CACHE TOPOGEO_SANITIZER PROPERTY STRINGS "" address thread)

set(TOPOGEO_SANITIZER_FACTOR 1)
if(TOPOGEO_SANITIZER STREQUAL "address")
  set(flags -fsanitize=address,undefined -fno-sanitize-recover=undefined)
  set(TOPOGEO_SANITIZER_FACTOR 5)
elseif(TOPOGEO_SANITIZER STREQUAL "thread")
  set(flags -fsanitize=thread)
  set(TOPOGEO_SANITIZER_FACTOR 10)
elseif(NOT TOPOGEO_SANITIZER STREQUAL "")
  message(FATAL_ERROR "TOPOGEO_SANITIZER is '${TOPOGEO_SANITIZER}', expected address, thread or nothing")
endif()
if(TOPOGEO_SANITIZER)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-omit-frame-pointer> "$<$<COMPILE_LANGUAGE:CXX>:${flags}>")
  add_link_options(${flags})
  add_compile_definitions(TOPOGEO_TIME_FACTOR=${TOPOGEO_SANITIZER_FACTOR})
endif()
