# Writes a file for ctest with one test for each suite of a GoogleTest program, and their names as `suites`:
# cmake -D PROGRAM=FILE -D NAME=TEXT -D OUTPUT=FILE -P ListTestSuites.cmake
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
# Cases are indented; a suite is "Name." or "Prefix/Name/0.", with a comment after typed ones.
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." found "${listing}")
string(REGEX REPLACE "[\n.]" "" suites "${found}")
set(content "set(suites [==[${suites}]==])\n")
foreach(suite IN LISTS suites)
  string(APPEND content "add_test([==[${NAME}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n")
endforeach()
file(WRITE ${OUTPUT} "${content}")
