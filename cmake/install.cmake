include(CMakePackageConfigHelpers)

install(TARGETS exitance_geometry exitance_radiosity EXPORT exitanceTargets)
install(TARGETS exitance)
foreach(folder geometry src)
  install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/exitance/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN cli EXCLUDE)
endforeach()
install(EXPORT exitanceTargets NAMESPACE exitance:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/exitance)
configure_package_config_file(cmake/exitanceConfig.cmake.in exitanceConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/exitance)
write_basic_package_version_file(exitanceConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/exitanceConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/exitanceConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/exitance)
