# Turns IDL into a static library with fastddsgen (package fastddsgen, needs a Java runtime).

find_program(FASTDDSGEN fastddsgen REQUIRED)

# topogeo_add_idl(NAME idl FILES a.idl ... [FOLDER topogeo/msg] [UNBOUNDED]): library topogeo_<name>, alias
# topogeo::<name>, headers <folder>/<file>.h, all of them in <folder>/types.h, the type supports of Fast DDS in
# <folder>/type_supports.h, the bounds of sequences and enumerations in <folder>/bounds.h (not with UNBOUNDED). Files
# must come after those that they include.
#
# One call for all files, because the generator also writes the outputs of every included file and takes most of its
# time to start. It writes into a staging folder, and only changed files are copied, so that a changed file does not
# recompile the others.
#
# With fastddsgen 2, sed removes addresses in comments, which differ from run to run, and clears the buffer of a key
# before each use: the rest of an earlier, longer key in the padding would give one instance two handles. The code of
# fastddsgen 4 is changed by fastddsgen4.py, and <file>.h includes its <file>.hpp.
function(topogeo_add_idl)
  cmake_parse_arguments(ARG "UNBOUNDED" "NAME;FOLDER" "FILES" ${ARGN})
  if(NOT ARG_FOLDER)
    set(ARG_FOLDER topogeo/msg)
  endif()
  set(staging ${CMAKE_CURRENT_BINARY_DIR}/staging)
  set(include_dir ${CMAKE_CURRENT_BINARY_DIR}/include)
  set(generated ${include_dir}/${ARG_FOLDER})
  file(MAKE_DIRECTORY ${staging} ${generated})  # the generator does not create its output folder

  set(staged "")
  set(staged_types "")
  set(staged_keys "")
  set(outputs "")
  foreach(file IN LISTS ARG_FILES)
    cmake_path(GET file STEM stem)
    list(APPEND staged_types ${staging}/${stem}.cxx)
    list(APPEND staged_keys ${staging}/${stem}PubSubTypes.cxx)
    if(TOPOGEO_FASTDDSGEN_MAJOR EQUAL 4)
      set(names ${stem}.hpp ${stem}CdrAux.hpp ${stem}CdrAux.ipp ${stem}PubSubTypes.hpp ${stem}PubSubTypes.cxx)
      foreach(name ${stem} ${stem}PubSubTypes)
        file(CONFIGURE OUTPUT ${generated}/${name}.h CONTENT "#pragma once\n\n#include \"${name}.hpp\"\n")
      endforeach()
    else()
      set(names ${stem}.h ${stem}.cxx ${stem}PubSubTypes.h ${stem}PubSubTypes.cxx)
    endif()
    list(TRANSFORM names PREPEND ${staging}/ OUTPUT_VARIABLE staged_names)
    list(TRANSFORM names PREPEND ${generated}/ OUTPUT_VARIABLE output_names)
    list(APPEND staged ${staged_names})
    list(APPEND outputs ${output_names})
  endforeach()
  set(types "")
  set(type_supports "")
  foreach(file IN LISTS ARG_FILES)
    cmake_path(GET file STEM stem)
    string(APPEND types "#include \"${ARG_FOLDER}/${stem}.h\"\n")
    string(APPEND type_supports "#include \"${ARG_FOLDER}/${stem}PubSubTypes.h\"\n")
  endforeach()
  file(CONFIGURE OUTPUT ${generated}/types.h CONTENT "#pragma once\n\n${types}")
  file(CONFIGURE OUTPUT ${generated}/type_supports.h CONTENT "#pragma once\n\n${type_supports}")
  set(bounds_output ${staging}/bounds.h)
  set(bounds_command COMMAND python3 ${PROJECT_SOURCE_DIR}/cmake/idl_bounds.py --staging ${staging}
                             --output ${bounds_output} --generator ${TOPOGEO_FASTDDSGEN_MAJOR} ${ARG_FILES})
  if(ARG_UNBOUNDED)
    set(bounds_command "")
    set(bounds_output "")
  else()
    configure_file(${PROJECT_SOURCE_DIR}/cmake/read_bounded.h ${generated}/read_bounded.h COPYONLY)
    list(APPEND outputs ${generated}/bounds.h)
  endif()
  set(sources ${outputs})
  list(FILTER sources INCLUDE REGEX "\\.cxx$")

  # -t: by default all runs on a machine share temporary files named after the IDL files.
  set(options -replace -cs -t ${staging} -d ${staging})
  set(show_log || ${CMAKE_COMMAND} -E env sh -c "cat '${staging}/log.txt' && false")
  if(TOPOGEO_FASTDDSGEN_MAJOR EQUAL 4)
    set(script ${PROJECT_SOURCE_DIR}/cmake/fastddsgen4.py)
    set(prepared "")
    foreach(file IN LISTS ARG_FILES)
      cmake_path(GET file FILENAME name)
      list(APPEND prepared ${staging}/idl/${name})
    endforeach()
    file(MAKE_DIRECTORY ${staging}/idl)
    set(generate
      COMMAND python3 ${script} prepare --staging ${staging}/idl ${ARG_FILES}
      COMMAND ${FASTDDSGEN} ${options} -flat-output-dir -no-typeobjectsupport ${prepared} > ${staging}/log.txt ${show_log}
      COMMAND python3 ${script} finish --staging ${staging} ${ARG_FILES})
  else()
    set(script "")
    set(generate
      COMMAND ${FASTDDSGEN} ${options} ${ARG_FILES} > ${staging}/log.txt ${show_log}
      COMMAND sed -i -E -e "s/TypeCode@[0-9a-f]+/TypeCode/" ${staged_types}
      COMMAND sed -i -E
              -e "s/^( +)p_type->serializeKey\\(ser\\)$<SEMICOLON>/\\1memset(m_keyBuffer, 0, p_type->getKeyMaxCdrSerializedSize())$<SEMICOLON>\\n&/"
              ${staged_keys})
  endif()
  add_custom_command(
    OUTPUT ${outputs}
    ${generate}
    ${bounds_command}
    COMMAND ${CMAKE_COMMAND} -E copy_if_different ${staged} ${bounds_output} ${generated}
    DEPENDS ${ARG_FILES} ${PROJECT_SOURCE_DIR}/cmake/idl_bounds.py ${script}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    COMMENT "Generating message types from IDL"
    VERBATIM)

  set(target topogeo_${ARG_NAME})
  add_library(${target} STATIC ${sources})
  add_library(topogeo::${ARG_NAME} ALIAS ${target})
  # SYSTEM: generated headers do not satisfy our warnings.
  target_include_directories(${target} SYSTEM PUBLIC $<BUILD_INTERFACE:${include_dir}>
                                                     $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} PUBLIC fastcdr ${TOPOGEO_FAST_DDS})
  target_compile_definitions(${target} PUBLIC ${TOPOGEO_FAST_DDS_DEFINITIONS})
  target_compile_options(${target} PRIVATE -w ${TOPOGEO_COLD_OPTIMIZATION})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TOPOGEO_UNITY} UNITY_BUILD_BATCH_SIZE 12)
endfunction()
