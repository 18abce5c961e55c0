# add_manual(<target> INCLUDE <file> COMMANDS <name>...)
#
# Makes manual pages from what `target` and its commands say of themselves, and installs them. Without help2man there
# are none, and a sanitized program has none.
find_program(HELP2MAN help2man)

function(add_manual target)
  cmake_parse_arguments(arg "" "INCLUDE" "COMMANDS" ${ARGN})
  if(NOT HELP2MAN OR CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    return()
  endif()
  set(pages "")
  foreach(command IN ITEMS "" ${arg_COMMANDS})
    set(name ${target})
    set(run $<TARGET_FILE:${target}>)
    if(command)
      string(APPEND name -${command})
      string(APPEND run " ${command}")
    endif()
    set(page ${CMAKE_CURRENT_BINARY_DIR}/${name}.1)
    add_custom_command(
      OUTPUT ${page}.gz
      COMMAND ${HELP2MAN} --no-info --section=1 --source=${PROJECT_NAME} --version-string=${PROJECT_VERSION}
              --name "frictionless contact, solved with a guaranteed bound" --include=${arg_INCLUDE} --output=${page}
              ${run}
      COMMAND gzip --best --no-name --force ${page}
      DEPENDS ${target} ${arg_INCLUDE}
      VERBATIM)
    list(APPEND pages ${page}.gz)
  endforeach()
  add_custom_target(manual ALL DEPENDS ${pages})
  include(GNUInstallDirs)
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endfunction()
