# cmake -DOUTPUT=bounds.h -DFILES="a.idl;b.idl" -DSTAGING=folder -P IdlBounds.cmake: changes the code of fastddsgen in
# that folder, a.cxx and b.cxx, to read no more elements of a sequence than its bound (read_bounded.h), and writes a
# header with the bounds of all structs, for checks of received messages and of those to be sent:
#
#   template <class Check> void visit_bounds(const LocalMap& message, Check& check);
#
# calls check.schema(version) for a top-level message, check.size(field, size, bound) for each sequence,
# check.value(field, value, last) for each enumeration and check.key(field, key, text) for each <text>_key after a
# string <text> or <text>_id, with check.inside(field, body) around the calls for members. Files must come after those
# that they include, and a member must be on one line.

cmake_minimum_required(VERSION 3.25)

set(plain_type "(unsigned )?(short|long|long long)|octet|boolean|float|double|string<[0-9]+>")
set(structs "")          # all so far
set(structs_to_visit "") # those of them that have anything to check
set(enums "")
set(typedefs "")
set(functions "")

function(fail file struct line)
  message(FATAL_ERROR "${file}: ${struct}: expected a member 'type name' with a known type: '${line}'")
endfunction()

# Changes `source` of the caller, the code of fastddsgen, to read at most `bound` elements into `name` of `struct`.
function(bound_reading struct name bound)
  set(read "dcdr >> m_${name};")
  string(FIND "${source}" "void topogeo::msg::${struct}::deserialize(" begin)
  if(begin EQUAL -1)
    message(FATAL_ERROR "no code reads ${struct}")
  endif()
  string(SUBSTRING "${source}" 0 ${begin} before)
  string(SUBSTRING "${source}" ${begin} -1 function)
  string(FIND "${function}" "${read}" begin)
  string(FIND "${function}" "\n}" end)
  if(begin EQUAL -1 OR begin GREATER end)
    message(FATAL_ERROR "no code reads ${name} of ${struct}")
  endif()
  string(LENGTH "${read}" length)
  math(EXPR end "${begin} + ${length}")
  string(SUBSTRING "${function}" ${end} -1 after)
  string(SUBSTRING "${function}" 0 ${begin} function)
  set(source "${before}${function}topogeo::msg::read_bounded(dcdr, m_${name}, ${bound});${after}" PARENT_SCOPE)
endfunction()

# Adds the check of one member to `code` of the caller.
macro(add_member file struct line)
  if("${line}" MATCHES "^sequence<([A-Za-z0-9_ ]+), *([A-Za-z0-9_]+)> ([a-zA-Z0-9_]+)$")
    set(type "${CMAKE_MATCH_1}")
    set(bound "${CMAKE_MATCH_2}")
    set(name "${CMAKE_MATCH_3}")
    bound_reading(${struct} ${name} topogeo::msg::${bound})
    string(APPEND code "  check.size(\"${name}\", message.${name}().size(), ${bound});\n")
    if(type IN_LIST structs_to_visit)
      string(APPEND code "  check.inside(\"${name}\", [&] {\n"
                         "    for (const ${type}& entry : message.${name}()) visit_bounds(entry, check);\n  });\n")
    elseif(NOT type IN_LIST structs AND NOT type MATCHES "^(${plain_type})$")
      fail("${file}" "${struct}" "${line}")
    endif()
  elseif("${line}" MATCHES "^([A-Za-z0-9_<> ]+) ([a-zA-Z0-9_]+)$")
    set(type "${CMAKE_MATCH_1}")
    set(name "${CMAKE_MATCH_2}")
    if(name STREQUAL "schema_version")
      string(APPEND code "  check.schema(message.schema_version());\n")
    elseif(name MATCHES "^(.+)_key$")
      set(text "${CMAKE_MATCH_1}")
      if("${text}_id" IN_LIST names)
        set(text "${text}_id")
      elseif(NOT text IN_LIST names)
        fail("${file}" "${struct}" "${line}")
      endif()
      string(APPEND code "  check.key(\"${name}\", message.${name}(), message.${text}());\n")
    elseif(type IN_LIST enums)
      string(APPEND code "  check.value(\"${name}\", message.${name}(), ${last_of_${type}});\n")
    elseif(type IN_LIST structs_to_visit)
      string(APPEND code "  check.inside(\"${name}\", [&] { visit_bounds(message.${name}(), check); });\n")
    elseif(NOT type IN_LIST structs AND NOT type IN_LIST typedefs AND NOT type MATCHES "^(${plain_type})$")
      fail("${file}" "${struct}" "${line}")
    endif()
    list(APPEND names ${name})
  else()
    fail("${file}" "${struct}" "${line}")
  endif()
endmacro()

foreach(file IN LISTS FILES)
  cmake_path(GET file STEM stem)
  file(READ ${STAGING}/${stem}.cxx source)
  string(REPLACE "#include <fastcdr/Cdr.h>\n" "#include <fastcdr/Cdr.h>\n\n#include \"read_bounded.h\"\n" source
         "${source}")
  file(READ ${file} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX MATCHALL "typedef [a-z ]+ [A-Za-z0-9]+" found "${text}")
  foreach(typedef IN LISTS found)
    string(REGEX REPLACE ".* " "" name "${typedef}")
    list(APPEND typedefs ${name})
  endforeach()
  string(REGEX REPLACE "[;,] *\n" "\n" text "${text}")  # ends of members and enumerators
  string(REGEX MATCHALL "(struct|enum) [A-Za-z0-9_]+ {[^}]*}" blocks "${text}")
  foreach(block IN LISTS blocks)
    string(REGEX MATCH "^(struct|enum) ([A-Za-z0-9_]+) {([^}]*)}" block "${block}")
    set(kind ${CMAKE_MATCH_1})
    set(struct ${CMAKE_MATCH_2})
    string(REGEX MATCHALL "[^\n]+" lines "${CMAKE_MATCH_3}")
    set(code "")
    set(names "")
    foreach(line IN LISTS lines)
      string(STRIP "${line}" line)
      string(REGEX REPLACE "^@key +" "" line "${line}")
      if(line STREQUAL "")
        continue()
      elseif(kind STREQUAL "enum")
        set(last_of_${struct} ${line})
      else()
        add_member(${file} ${struct} "${line}")
      endif()
    endforeach()
    if(kind STREQUAL "enum")
      list(APPEND enums ${struct})
      continue()
    endif()
    list(APPEND structs ${struct})
    if(NOT code STREQUAL "")
      list(APPEND structs_to_visit ${struct})
      string(APPEND functions "\ntemplate <class Check>\nvoid visit_bounds(const ${struct}& message, "
                              "Check& check) {\n${code}}\n")
    endif()
  endforeach()
  file(WRITE ${STAGING}/${stem}.cxx "${source}")
endforeach()

file(WRITE ${OUTPUT} "// Bounds of the messages, generated from the IDL by cmake/IdlBounds.cmake.\n#pragma once\n\n"
                     "#include \"types.h\"\n\nnamespace topogeo::msg {\n${functions}\n}  // namespace topogeo::msg\n")
