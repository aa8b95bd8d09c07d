# Installing: the program, both libraries, the headers of the modules, CMake and pkg-config packages, manual page and
# completion. A consumer says find_package(Plantimeter) and links Plantimeter::plantimeter (shared), or asks for the
# component `static` and links Plantimeter::plantimeter_static.
include(CMakePackageConfigHelpers)

set(headers include/plantimeter)
file(WRITE ${PROJECT_BINARY_DIR}/generated/plantimeter.h
     "/* plantimeter.h: the whole public interface of Plantimeter ${PROJECT_VERSION}. */\n#pragma once\n")
foreach(module cloud io segment mesh traits reports simulate selftest)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${module}/${module}.h AND TARGET plm_${module})
    install(FILES ${PROJECT_SOURCE_DIR}/${module}/${module}.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plantimeter/${module})
    file(APPEND ${PROJECT_BINARY_DIR}/generated/plantimeter.h "#include \"${module}/${module}.h\"\n")
  endif()
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/plantimeter.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plantimeter)

install(TARGETS plantimeter RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS plantimeter_shared EXPORT PlantimeterTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS plantimeter_static EXPORT PlantimeterStaticTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
set_target_properties(plantimeter_shared PROPERTIES EXPORT_NAME plantimeter)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Plantimeter)
install(EXPORT PlantimeterTargets NAMESPACE Plantimeter:: DESTINATION ${package})
install(EXPORT PlantimeterStaticTargets NAMESPACE Plantimeter:: DESTINATION ${package})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/PlantimeterConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/PlantimeterConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/PlantimeterConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/PlantimeterConfig.cmake ${PROJECT_BINARY_DIR}/PlantimeterConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/PlantimeterLibraries.cmake DESTINATION ${package})

file(RELATIVE_PATH PLANTIMETER_PC_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/plantimeter.pc.in ${PROJECT_BINARY_DIR}/plantimeter.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/plantimeter.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The manual page and the completion are printed by the program from its own option tables.
set(manual ${PROJECT_BINARY_DIR}/plantimeter.1)
set(completion ${PROJECT_BINARY_DIR}/plantimeter.bash)
add_custom_command(OUTPUT ${manual} ${completion}
                   COMMAND plantimeter help --man > ${manual}
                   COMMAND plantimeter help --completion > ${completion}
                   DEPENDS plantimeter VERBATIM)
add_custom_target(plantimeter_manual ALL DEPENDS ${manual} ${completion})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME plantimeter)
