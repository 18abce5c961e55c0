# Writes OUTPUT, the C++ source of FUNCTION, which returns the texts of the list FILES by name: `const
# std::vector<TYPE>& FUNCTION()` in the namespace NAMESPACE, declared in HEADER; TYPE is built from a name, the
# file's without `.json`, and a text.

# Raw string literals: compilers guarantee 65536 characters each.
set(longest_literal 65536)

set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(REGEX REPLACE "[.]json$" "" name ${name})
  file(READ ${file} text)
  string(LENGTH "${text}" length)
  if(length GREATER longest_literal)
    message(FATAL_ERROR "${file} has ${length} characters; an embedded text may have ${longest_literal}.")
  endif()
  string(APPEND entries "      {\"${name}\", R\"embedded(${text})embedded\"},\n")
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
