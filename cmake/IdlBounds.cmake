# cmake -DOUTPUT=bounds.h -DFILES="a.idl;b.idl" -P IdlBounds.cmake: writes a header with the bounds of all
# structs of the IDL files, which the code of fastddsgen does not check:
#
#   template <class Check> void visit_bounds(const LocalMap& message, Check& check);
#
# calls check.schema(version) for a top-level message, check.size(field, size, bound) for each sequence,
# check.value(field, value, last) for each enumeration and check.key(field, key, text) for each <text>_key
# after a string <text> or <text>_id, inside check.inside(field, body) for those of members. Files come after those that they include; a member stands on one line.

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

# Adds the check of one member to `code` of the caller.
macro(add_member file struct line)
  if("${line}" MATCHES "^sequence<([A-Za-z0-9_ ]+), *([A-Za-z0-9_]+)> ([a-zA-Z0-9_]+)$")
    set(type "${CMAKE_MATCH_1}")
    set(bound "${CMAKE_MATCH_2}")
    set(name "${CMAKE_MATCH_3}")
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
endforeach()

file(WRITE ${OUTPUT} "// Bounds of the messages, generated from the IDL by cmake/IdlBounds.cmake.\n#pragma once\n\n"
                     "#include \"types.h\"\n\nnamespace topogeo::msg {\n${functions}\n}  // namespace topogeo::msg\n")
