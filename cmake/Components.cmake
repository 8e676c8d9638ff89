# isoline_components(folder ENTRY Entry HEADER header CORE files...)
#
# Builds library isoline_<folder> from every <folder>/**.cpp and writes the registry that names them:
# <folder>/heat.cpp must define register_heat(Registry<Entry>&). Files after CORE are compiled only;
# so are those of folders below, unless they define their function too.
function(isoline_components folder)
  cmake_parse_arguments(PARSE_ARGV 1 "" "" "ENTRY;HEADER" "CORE")
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  list(SORT files)
  foreach(file IN LISTS files)
    cmake_path(GET file STEM name)
    file(STRINGS ${file} definition REGEX "void register_${name}\\(" LIMIT_COUNT 1)
    if(definition AND NOT file IN_LIST _CORE)
      string(APPEND declarations "void register_${name}(Registry<${_ENTRY}>&);\n")
      string(APPEND calls "  register_${name}(registry);\n")
    elseif(NOT file MATCHES "/" AND NOT file IN_LIST _CORE)
      message(FATAL_ERROR "${folder}/${file} must define register_${name}(Registry<${_ENTRY}>&); a file "
                          "that is no component belongs in a folder below or after CORE in "
                          "${folder}/CMakeLists.txt")
    endif()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/registry.cpp.in registry.cpp @ONLY)
  add_library(isoline_${folder} STATIC ${files} ${CMAKE_CURRENT_BINARY_DIR}/registry.cpp)
  add_library(Isoline::${folder} ALIAS isoline_${folder})
endfunction()
