# What `cmake --install` puts where, and the packages that CPack makes of it: the program; the library; what it takes to
# build against the library.
include(CMakePackageConfigHelpers)

install(TARGETS graphdrl COMPONENT program)
install(TARGETS graphdrl_shared EXPORT graphdrl
  LIBRARY COMPONENT library NAMELINK_COMPONENT development)
install(DIRECTORY include/graphdrl TYPE INCLUDE COMPONENT development)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/graphdrl)
install(EXPORT graphdrl NAMESPACE graphdrl:: FILE graphdrlTargets.cmake DESTINATION ${package_folder}
  COMPONENT development)
configure_package_config_file(cmake/graphdrlConfig.cmake.in graphdrlConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(graphdrlConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/graphdrlConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/graphdrlConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
file(RELATIVE_PATH prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /.)
configure_file(cmake/graphdrl.pc.in graphdrl.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/graphdrl.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)

# Manual pages and completions come from the program's own tables of options.
set(share ${CMAKE_CURRENT_BINARY_DIR}/share)
add_custom_command(OUTPUT ${share}/stamp
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${share}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${share}
  COMMAND graphdrl completion --install ${share}
  COMMAND ${CMAKE_COMMAND} -E touch ${share}/stamp
  DEPENDS graphdrl VERBATIM)
add_custom_target(manual ALL DEPENDS ${share}/stamp)
install(DIRECTORY ${share}/ DESTINATION ${CMAKE_INSTALL_DATAROOTDIR} COMPONENT program PATTERN stamp EXCLUDE)

set(CPACK_PACKAGE_NAME graphdrl)
set(CPACK_PACKAGE_VENDOR "The GraphDRL authors")
set(CPACK_PACKAGE_CONTACT "The GraphDRL authors <graphdrl@localhost>")
set(CPACK_GENERATOR DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program library development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME graphdrl)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libgraphdrl${GRAPHDRL_SOVERSION})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libgraphdrl-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libgraphdrl${GRAPHDRL_SOVERSION} (= ${PROJECT_VERSION})")
foreach(component program library development)
  string(TOUPPER ${component} upper)
  string(CONCAT CPACK_COMPONENT_${upper}_DESCRIPTION
    "walks that visit as many nodes of a graph as a budget allows: ${component}\n"
    "Plans walks on graphs and maps, with a bound on how much better any walk can be.")
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} RENAME copyright COMPONENT ${component})
endforeach()
include(CPack)
