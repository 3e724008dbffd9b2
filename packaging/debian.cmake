# Debian packages, one a component, by CPack; scripts/package calls it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME docent)
set(CPACK_PACKAGE_VENDOR "Docent")
set(CPACK_PACKAGE_CONTACT "Docent maintainers <maintainers@docent.invalid>")
set(CPACK_PACKAGE_HOMEPAGE_URL "https://w3id.org/docent")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # would stand above that of each package
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL docent docent-dev docent-doc)
if(DOCENT_BUILD_ROBOT)
  list(APPEND CPACK_COMPONENTS_ALL docent-robot docent-robot-replay)
endif()
if(TARGET redland_module)
  list(APPEND CPACK_COMPONENTS_ALL docent-redland)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# docent_package(NAME SECTION SUMMARY TEXT): its name, and the documents that every package has.
function(docent_package name section summary text)
  string(TOUPPER ${name} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/debian/copyright DESTINATION ${doc} COMPONENT ${name})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${doc} COMPONENT ${name})
endfunction()

add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
  COMMAND gzip -9nc ${CMAKE_CURRENT_SOURCE_DIR}/debian/changelog > ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
  DEPENDS debian/changelog)
add_custom_target(docent_changelog ALL DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz)

docent_package(docent net "semantic context-reasoning server for service robots"
  "Docent keeps a live RDF graph of a place: people, robots, sensors,
services. It reasons over the graph, answers SPARQL, and runs workflows
whose steps start when the graph says that the situation is right. This
package has the server, its command line, a systemd unit, ontologies,
scenarios and the gRPC definitions.")
docent_package(docent-robot net "simulated guide robot for Docent"
  "A robot adapter that localises with the particle filter of MRPT, plans paths,
drives in a simulated hall, shows pages and speaks, as a Docent server commands.")
docent_package(docent-robot-replay net "replay of recorded robots for Docent"
  "What docent-robot needs to replay the log of a real robot: a module that
reads the rawlogs and maps of MRPT, and depends on it.")
docent_package(docent-redland libs "Redland RDF storage of Docent graphs"
  "A storage module of librdf: Redland programs open the graph of a running
Docent server, or a data folder, as a storage named docent.")
docent_package(docent-dev libdevel "SDK of robot adapters for Docent"
  "Headers, static libraries and a CMake package with which a few functions
become a robot that a Docent server can command.")
docent_package(docent-doc doc "documentation of Docent"
  "Tutorials, concepts, references and operations of Docent.")

set(CPACK_DEBIAN_DOCENT_PACKAGE_CONTROL_EXTRA
  ${CMAKE_CURRENT_SOURCE_DIR}/debian/conffiles;${CMAKE_CURRENT_SOURCE_DIR}/debian/postinst;${CMAKE_CURRENT_SOURCE_DIR}/debian/prerm;${CMAKE_CURRENT_SOURCE_DIR}/debian/postrm)
set(CPACK_DEBIAN_DOCENT_PACKAGE_DEPENDS "tzdata")  # time zones; libraries are found by their names
set(CPACK_DEBIAN_DOCENT_PACKAGE_SUGGESTS "docent-robot, docent-doc, redland-utils")
set(CPACK_DEBIAN_DOCENT-ROBOT_PACKAGE_DEPENDS "docent (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DOCENT-ROBOT_PACKAGE_RECOMMENDS "espeak-ng")
set(CPACK_DEBIAN_DOCENT-ROBOT_PACKAGE_SUGGESTS "docent-robot-replay")
set(CPACK_DEBIAN_DOCENT-ROBOT-REPLAY_PACKAGE_DEPENDS "docent-robot (= ${PROJECT_VERSION}), mrpt-common")
set(CPACK_DEBIAN_DOCENT-DEV_PACKAGE_DEPENDS "libgrpc++-dev, libprotobuf-dev, protobuf-compiler-grpc, libabsl-dev, libspdlog-dev, zlib1g-dev, libssl-dev")
set(CPACK_DEBIAN_DOCENT-DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCENT-DOC_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DOCENT-DEV_PACKAGE_SHLIBDEPS OFF)
include(CPack)
