# Checks one unit and prints the findings of clang-tidy, each once, with paths relative to the project:
# cmake -D TIDY=PROGRAM -D BUILD=DIR -D UNIT=FILE -D FOLDER=DIR -P RunClangTidy.cmake
#
# -Wno-error: the compiler of the build decides which warnings are errors, not clang's own set.
execute_process(COMMAND ${TIDY} -p ${BUILD} --quiet --extra-arg=-Wno-error ${UNIT}
  OUTPUT_VARIABLE findings ERROR_VARIABLE messages RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  string(REPLACE "${FOLDER}/" "" findings "${findings}")
  if(findings STREQUAL "")
    set(findings "${messages}")
  endif()
  message("${findings}")
  message(FATAL_ERROR "clang-tidy found faults")
endif()
