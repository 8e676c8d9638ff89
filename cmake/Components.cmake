# isoline_components(folder ENTRY Entry HEADER header CORE files...)
#
# Builds library isoline_<folder> from every <folder>/*.cpp and writes the registry that names them:
# <folder>/heat.cpp must define register_heat(Registry<Entry>&). Files after CORE, and those of folders
# below, are compiled only.
function(isoline_components folder)
  cmake_parse_arguments(PARSE_ARGV 1 "" "" "ENTRY;HEADER" "CORE")
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  list(SORT files)
  foreach(file IN LISTS files)
    if(NOT file IN_LIST _CORE)
      cmake_path(GET file STEM name)
      string(APPEND declarations "void register_${name}(Registry<${_ENTRY}>&);\n")
      string(APPEND calls "  register_${name}(registry);\n")
    endif()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/registry.cpp.in registry.cpp @ONLY)
  file(GLOB parts CONFIGURE_DEPENDS */*.cpp)
  add_library(isoline_${folder} STATIC ${files} ${parts} ${CMAKE_CURRENT_BINARY_DIR}/registry.cpp)
  add_library(Isoline::${folder} ALIAS isoline_${folder})
endfunction()
