# embed_texts(<variable> FUNCTION <name> TYPE <type> NAMESPACE <namespace> HEADER <header> [LIGHT|BYTES] FILES <file>...)
#
# Compiles files into the program: sets the variable to a source that is written again when one of the files
# changes. LIGHT: scripts and styles are minified. BYTES: they are no texts. See embed_texts.cmake.
find_program(ESBUILD esbuild REQUIRED)
set(embed_texts_script ${CMAKE_CURRENT_LIST_DIR}/embed_texts.cmake)

function(embed_texts variable)
  cmake_parse_arguments(arg "LIGHT;BYTES" "FUNCTION;TYPE;NAMESPACE;HEADER" "FILES" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${arg_FUNCTION}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -D OUTPUT=${source} -D FUNCTION=${arg_FUNCTION} -D TYPE=${arg_TYPE}
            -D NAMESPACE=${arg_NAMESPACE} -D HEADER=${arg_HEADER} -D LIGHT=${arg_LIGHT} -D BYTES=${arg_BYTES} -D ESBUILD=${ESBUILD}
            -D "FILES=${arg_FILES}" -P ${embed_texts_script}
    DEPENDS ${arg_FILES} ${embed_texts_script}
    COMMENT "Embedding ${arg_FUNCTION}"
    VERBATIM)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()
