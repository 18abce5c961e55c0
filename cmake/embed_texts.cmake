# Writes OUTPUT, the C++ source of FUNCTION, which returns the texts of the list FILES by name: `const
# std::vector<TYPE>& FUNCTION()` in the namespace NAMESPACE, declared in HEADER; TYPE is built from a name, the
# file's without `.json`, and a text. If LIGHT is true, the texts come without what only their readers need, and browsers
# load less: without comments (`//` at the beginning of a line or between blanks, so that no string may contain it; in a
# style `/* */`), indentation, the ends of lines that a bracket, comma or semicolon ends too, and the blanks of styles. If
# BYTES is true, they are taken byte by byte.

# Raw string literals that follow each other are one; compilers guarantee 65536 characters each.
set(longest_literal 65536)

set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(REGEX REPLACE "[.]json$" "" name ${name})
  if(BYTES)
    file(READ ${file} text HEX)
    string(LENGTH "${text}" length)
    math(EXPR length "${length} / 2")
    string(REGEX REPLACE "(..)" "\\\\x\\1" text "${text}")
    string(APPEND entries "      {\"${name}\", std::string(\"${text}\", ${length})},\n")
    continue()
  endif()
  file(READ ${file} text)
  if(LIGHT)
    string(REGEX REPLACE "\n[ \t]+" "\n" text "\n${text}")
    string(REGEX REPLACE "\n//[^\n]*" "" text "${text}")
    string(REGEX REPLACE " +// [^\n]*" "" text "${text}")
    string(REGEX REPLACE "\n+" "\n" text "${text}")
    string(REGEX REPLACE "([;{,(])\n" "\\1" text "${text}")
    string(REGEX REPLACE "\n([)}])" "\\1" text "${text}")
    if(file MATCHES "[.]css$")
      string(REGEX REPLACE "/[*][^*]*[*]/" "" text "${text}")
      string(REGEX REPLACE "([a-z]:|[;,{}])[ \n]+" "\\1" text "${text}")
      string(REGEX REPLACE " ([{}])" "\\1" text "${text}")
      string(REPLACE ";}" "}" text "${text}")
    endif()
    string(STRIP "${text}" text)
  endif()
  string(LENGTH "${text}" length)
  set(literals "")
  foreach(begin RANGE 0 ${length} ${longest_literal})
    string(SUBSTRING "${text}" ${begin} ${longest_literal} piece)
    string(APPEND literals " R\"embedded(${piece})embedded\"")
  endforeach()
  string(APPEND entries "      {\"${name}\",${literals}},\n")
endforeach()

file(WRITE ${OUTPUT} "// Written by cmake/embed_texts.cmake.
#include \"${HEADER}\"

namespace ${NAMESPACE} {

const std::vector<${TYPE}>& ${FUNCTION}() {
  static const std::vector<${TYPE}> all{
${entries}  };
  return all;
}

}  // namespace ${NAMESPACE}
")
