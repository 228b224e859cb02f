# Checks one unit and prints what clang-tidy finds, each finding once, with paths of the project:
# cmake -D TIDY=PROGRAM -D BUILD=DIR -D UNIT=FILE -D FOLDER=DIR -P RunClangTidy.cmake
#
# -Wno-error: which warnings are faults is up to the compiler of the build, not to clang's own set.
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
