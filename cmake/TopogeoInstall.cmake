# Installed files, and the Debian packages of them. Three components, a package each:
#   topogeo          the command line, the services of a robot, documents and examples
#   topogeo-workers  the search worker, files that both need, and the unit of discovery servers; alone on a machine off
#                    the robot
#   topogeo-dev      IDL, headers and libraries for programs that read and write our topics
# The programs are in libexec/topogeo, where `topogeo run` finds them beside itself; bin has links.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(programs ${CMAKE_INSTALL_LIBEXECDIR}/topogeo)
set(robot_services sensor_gateway local_mapper localizer map_store planner navigator simulator ros_bridge web)
set(generated ${CMAKE_BINARY_DIR}/package)
file(MAKE_DIRECTORY ${generated})

# topogeo_install_program(TARGET COMMAND COMPONENT): the program, a link with this name in bin, and its manual page and
# completion, which the program itself prints.
function(topogeo_install_program target command component)
  install(TARGETS ${target} RUNTIME DESTINATION ${programs} COMPONENT ${component})
  file(RELATIVE_PATH path /${CMAKE_INSTALL_BINDIR} /${programs}/${target})
  file(CREATE_LINK ${path} ${generated}/${command} SYMBOLIC)
  install(FILES ${generated}/${command} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  add_custom_command(OUTPUT ${generated}/${command}.1.gz ${generated}/${command}.bash
    COMMAND sh -c "'$<TARGET_FILE:${target}>' --print-manual | sed 's/^${target} /${command} /; s/^\\.B ${target}$/.B ${command}/' | gzip -9n > '${generated}/${command}.1.gz'"
    COMMAND sh -c "'$<TARGET_FILE:${target}>' --print-completion | sed 's/ ${target}$/ ${command}/' > '${generated}/${command}.bash'"
    DEPENDS ${target} VERBATIM)
  set_property(GLOBAL APPEND PROPERTY TOPOGEO_MANUALS ${generated}/${command}.1.gz)
  install(FILES ${generated}/${command}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${generated}/${command}.bash RENAME ${command}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT ${component})
endfunction()

topogeo_install_program(topogeo topogeo topogeo)
foreach(service IN LISTS robot_services)
  string(REPLACE _ - command topogeo-${service})
  topogeo_install_program(${service} ${command} topogeo)
endforeach()
topogeo_install_program(ga_worker ga_worker topogeo-workers)
get_property(manuals GLOBAL PROPERTY TOPOGEO_MANUALS)
# A page for each command of topogeo, topogeo-map.1. Some commands share the name of a service, whose page comes first.
set(command_pages ${generated}/commands)
file(WRITE ${generated}/make_command_pages.sh [=[
set -eu  # PROGRAM PAGES FOLDER
rm -rf "$3"
mkdir -p "$3"
for name in $("$1" --print-commands); do
  page=topogeo-$name.1.gz
  [ ! -e "$2/$page" ] || cp "$2/$page" "$3/$page"
  "$1" --print-manual "$name" | gzip -9n >> "$3/$page"
done
touch "$3.stamp"
]=])
add_custom_command(OUTPUT ${command_pages}.stamp
  COMMAND sh ${generated}/make_command_pages.sh $<TARGET_FILE:topogeo> ${generated} ${command_pages}
  DEPENDS topogeo ${manuals} ${generated}/make_command_pages.sh VERBATIM)
install(DIRECTORY ${command_pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT topogeo)
# Also part of plain builds, so that cmake --install finds them.
add_custom_target(manuals ALL DEPENDS ${manuals} ${command_pages}.stamp)

set(data ${CMAKE_INSTALL_DATADIR}/topogeo)
set(deploy ${PROJECT_SOURCE_DIR}/deploy)
install(DIRECTORY ${deploy}/systemd/ DESTINATION lib/systemd/system COMPONENT topogeo
        FILES_MATCHING PATTERN "*.service" PATTERN "*.target" PATTERN "topogeo-*@*" EXCLUDE)
install(FILES ${deploy}/udev/60-topogeo.rules DESTINATION lib/udev/rules.d COMPONENT topogeo)
install(FILES ${deploy}/systemd/topogeo-worker@.service ${deploy}/systemd/system-topogeoworkers.slice
              ${deploy}/systemd/topogeo-discovery@.service
        DESTINATION lib/systemd/system COMPONENT topogeo-workers)
install(FILES ${deploy}/systemd/topogeo.env ${deploy}/systemd/web.env DESTINATION ${data}/etc COMPONENT topogeo)
install(FILES ${deploy}/systemd/worker.env DESTINATION ${data}/etc COMPONENT topogeo-workers)
install(FILES ${deploy}/dds_profiles.xml DESTINATION ${data} COMPONENT topogeo-workers)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/topogeo/web DESTINATION ${data} COMPONENT topogeo)
# Worlds, and configurations for them.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/share/ DESTINATION ${data} COMPONENT topogeo)
install(PROGRAMS ${deploy}/security/make_keys DESTINATION ${data}/security COMPONENT topogeo)
install(PROGRAMS ${deploy}/security/own_keys DESTINATION ${data}/security COMPONENT topogeo-workers)
install(FILES ${deploy}/security/permissions.txt DESTINATION ${data}/security COMPONENT topogeo)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT topogeo)
install(FILES ${deploy}/README.md ${deploy}/SCALING.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/deploy COMPONENT topogeo)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT topogeo)
install(DIRECTORY ${deploy}/kubernetes ${deploy}/monitoring DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT topogeo)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/ros2 DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT topogeo)
install(FILES ${deploy}/compose.yaml ${deploy}/devices.example.yaml
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT topogeo)

# ---- for subscribers ----
set(libraries geometry support idl map_client messaging)
foreach(library IN LISTS libraries)
  set_target_properties(topogeo_${library} PROPERTIES EXPORT_NAME ${library})
  target_compile_features(topogeo_${library} INTERFACE cxx_std_20)  # of the headers
  install(TARGETS topogeo_${library} EXPORT topogeo
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT topogeo-dev)
endforeach()
foreach(library geometry support map_client messaging)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/libs/${library}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
          COMPONENT topogeo-dev)
endforeach()
install(DIRECTORY ${CMAKE_BINARY_DIR}/libs/support/include/ ${CMAKE_BINARY_DIR}/idl/include/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT topogeo-dev FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/idl DESTINATION ${data} COMPONENT topogeo-dev
        FILES_MATCHING PATTERN "*.idl")
install(EXPORT topogeo NAMESPACE topogeo:: FILE topogeo-targets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/topogeo COMPONENT topogeo-dev)
write_basic_package_version_file(${generated}/topogeo-config-version.cmake COMPATIBILITY ExactVersion)
configure_file(${deploy}/package/topogeo-config.cmake ${generated}/topogeo-config.cmake @ONLY)
install(FILES ${generated}/topogeo-config.cmake ${generated}/topogeo-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/topogeo COMPONENT topogeo-dev)

# ---- Debian packages ----
file(CONFIGURE OUTPUT ${generated}/changelog CONTENT
"topogeo (${PROJECT_VERSION}) unstable; urgency=medium

  * Version ${PROJECT_VERSION}. The history of the project is in its repository.

 -- topogeo <topogeo@noreply.invalid>  Thu, 01 Jan 2026 00:00:00 +0000
")
find_program(GZIP gzip REQUIRED)
execute_process(COMMAND ${GZIP} -9nfk ${generated}/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(package topogeo topogeo-workers topogeo-dev)
  install(FILES ${deploy}/package/copyright ${generated}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${package})
endforeach()
install(FILES ${deploy}/package/lintian-overrides RENAME topogeo-dev
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT topogeo-dev)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "topogeo <topogeo@noreply.invalid>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_COMPONENTS_ALL topogeo topogeo-workers topogeo-dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# xz makes packages a third smaller but takes ten times as long.
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# topogeo_describe_package(NAME VARIABLE_PART SECTION DEPENDS TEXT)
macro(topogeo_describe_package name part section depends summary text)
  string(TOUPPER ${name} component)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${component}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_COMPONENT_${component}_DESCRIPTION "${summary}\n${text}")
endmacro()

topogeo_describe_package(topogeo TOPOGEO science "topogeo-workers (= ${PROJECT_VERSION})"
  "indoor maps, positions and routes for robots"
  "Services that map a floor from the scans of a laser, find and follow the
robot on the map, plan routes to named places and drive them. They speak
DDS.")
topogeo_describe_package(topogeo-workers WORKERS science ""
  "search workers of topogeo"
  "Help the robots of a network with the genetic search that matches their
local maps. Needs no settings. Has the unit of discovery servers, too.")
topogeo_describe_package(topogeo-dev DEV libdevel
  "libfastrtps-dev, libfastcdr-dev, libeigen3-dev, libfmt-dev, libspdlog-dev, libyaml-cpp-dev, libssl-dev, libsystemd-dev"
  "topogeo for programs that join its services"
  "The types of all topics as IDL and as C++, and the library that reads and
writes them.")
set(CPACK_DEBIAN_TOPOGEO_PACKAGE_RECOMMENDS "fastdds-tools, openssl")
set(CPACK_DEBIAN_TOPOGEO-WORKERS_PACKAGE_SUGGESTS "fastdds-tools")
# topogeo once had the unit of discovery servers.
set(CPACK_DEBIAN_TOPOGEO-WORKERS_PACKAGE_REPLACES "topogeo (<= 0.1.0)")
foreach(component TOPOGEO TOPOGEO-WORKERS)
  string(TOLOWER ${component} package)
  set(CPACK_DEBIAN_${component}_PACKAGE_CONTROL_EXTRA
    "${deploy}/package/${package}/postinst;${deploy}/package/${package}/prerm;${deploy}/package/${package}/postrm")
endforeach()
include(CPack)
