# Writes OUTPUT, the C++ source of FUNCTION, which returns the texts of the list FILES by name: `const
# std::vector<TYPE>& FUNCTION()` in the namespace NAMESPACE, declared in HEADER; TYPE is built from a name, the
# file's without `.json`, and a text. If LIGHT is true, scripts and styles come as ESBUILD minifies them: browsers load
# less. If BYTES is true, the files are taken byte by byte.

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
  if(LIGHT AND file MATCHES "[.](js|css)$")
    execute_process(COMMAND ${ESBUILD} --minify --charset=utf8 --log-level=warning ${file} OUTPUT_VARIABLE text
                    COMMAND_ERROR_IS_FATAL ANY)
  else()
    file(READ ${file} text)
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
