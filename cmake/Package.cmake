# The Debian package: cpack --config build/release/CPackConfig.cmake -G DEB.
set(CPACK_PACKAGE_NAME signorini)
set(CPACK_PACKAGE_VENDOR "The Signorini authors")
set(CPACK_PACKAGE_CONTACT "The Signorini authors <signorini@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "frictionless contact solved over HTTP with a guaranteed error bound")
set(CPACK_PACKAGE_DESCRIPTION "Solves two-dimensional unilateral contact without friction by the dual mixed finite
element method, as an HTTP service with jobs, or one problem at a time on the command line. Every answer has a bound
of its error that is proved.")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
