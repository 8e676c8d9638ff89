# `cmake --install` exports Isoline::core, Isoline::problems, … and isoline_program(). Other repositories
# find them with find_package(Isoline). Libraries in C need only isoline.h.
include(CMakePackageConfigHelpers)

set(libraries core networks problems optimizers reports benchmarks)
foreach(library IN LISTS libraries)
  set_target_properties(isoline_${library} PROPERTIES EXPORT_NAME ${library})
  install(TARGETS isoline_${library} EXPORT IsolineTargets)
  install(DIRECTORY ${library} DESTINATION include/isoline FILES_MATCHING PATTERN "*.h")
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/core/generated/ DESTINATION include/isoline)
set_target_properties(isoline_cli PROPERTIES EXPORT_NAME cli)  # its headers are benchmarks'
install(TARGETS isoline_cli EXPORT IsolineTargets)
install(DIRECTORY clients/python DESTINATION share/isoline COMPONENT program FILES_MATCHING
        PATTERN "*.py")
install(DIRECTORY clients/peers DESTINATION share/isoline COMPONENT program PATTERN __pycache__ EXCLUDE)
install(DIRECTORY benchmarks/published DESTINATION share/isoline COMPONENT program FILES_MATCHING
        PATTERN "*.json" PATTERN unfinished EXCLUDE PATTERN conduct.json EXCLUDE)
install(DIRECTORY docs DESTINATION share/doc/isoline COMPONENT program)
install(FILES README.md CHANGELOG.md DESTINATION share/doc/isoline COMPONENT program)
include(cmake/Package.cmake)

set(package lib/cmake/Isoline)
install(EXPORT IsolineTargets NAMESPACE Isoline:: DESTINATION ${package})
install(FILES cmake/Dependencies.cmake cmake/Commit.cmake cmake/BuildInfo.cmake
              cmake/Program.cmake cmake/program.cpp.in DESTINATION ${package})
install(FILES core/foreign/isoline.h DESTINATION include)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/IsolineConfig.cmake @ONLY CONTENT [[
include("${CMAKE_CURRENT_LIST_DIR}/Dependencies.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/IsolineTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/Commit.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/Program.cmake")
]])
write_basic_package_version_file(${PROJECT_BINARY_DIR}/IsolineConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/IsolineConfig.cmake
              ${PROJECT_BINARY_DIR}/IsolineConfigVersion.cmake DESTINATION ${package})
