# The SDK of robot adapters: headers, static libraries and a CMake package, so that
#   find_package(docent REQUIRED)
#   target_link_libraries(my_adapter docent::sdk)
# builds what includes "robot_adapters/sdk/robot_adapter.h".
include(CMakePackageConfigHelpers)
set(include ${CMAKE_INSTALL_INCLUDEDIR}/docent)
set(sdk_libraries docent_sdk docent_wire docent_rdf docent_base docent_proto)
foreach(library ${sdk_libraries})
  string(REPLACE docent_ "" short ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${short})
endforeach()
install(TARGETS ${sdk_libraries} EXPORT docent ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT docent-dev)

# The headers that an adapter may include, and what they include themselves.
foreach(header
    robot_adapters/sdk/robot_adapter.h robot_adapters/sdk/operation.h robot_adapters/sdk/fact_sender.h
    robot_adapters/sdk/server_link.h robot_adapters/sdk/decimal.h
    graph/base/clock.h graph/base/ids.h graph/rdf/term.h graph/rdf/vocabulary.h graph/wire/term_proto.h)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${include}/${folder} COMPONENT docent-dev)
endforeach()
install(DIRECTORY ${CMAKE_BINARY_DIR}/proto/docent DESTINATION ${include} COMPONENT docent-dev FILES_MATCHING PATTERN *.h)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/docent)
install(EXPORT docent NAMESPACE docent:: FILE docent-targets.cmake DESTINATION ${package} COMPONENT docent-dev)
configure_package_config_file(docent-config.cmake.in docent-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/docent-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/docent-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/docent-config-version.cmake
  DESTINATION ${package} COMPONENT docent-dev)

# CMake strips programs; of static libraries only what debuggers read may go.
install(CODE "
  if(CMAKE_INSTALL_DO_STRIP)
    foreach(library ${sdk_libraries})
      execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug --enable-deterministic-archives
        \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/lib\${library}.a\")
    endforeach()
  endif()" COMPONENT docent-dev)
