# isoline_registry(folder ENTRY Entry HEADER header [NAMESPACE namespace] CORE files...)
#
# Writes the registry of all components of <folder>: <folder>/heat.cpp must define
# register_heat(Registry<Entry>&). Files after CORE are only compiled, and so are files in subfolders
# that do not define their function. With NAMESPACE, <folder> is a subfolder of the calling folder. Sets
# <folder>_sources.
function(isoline_registry folder)
  cmake_parse_arguments(PARSE_ARGV 1 "" "" "ENTRY;HEADER;NAMESPACE" "CORE")
  set(path ${CMAKE_CURRENT_SOURCE_DIR})
  set(namespace ${folder})
  if(_NAMESPACE)
    set(path ${path}/${folder})
    set(namespace ${_NAMESPACE})
  endif()
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${path} ${path}/*.cpp)
  list(SORT files)
  foreach(file IN LISTS files)
    cmake_path(GET file STEM name)
    file(STRINGS ${path}/${file} definition REGEX "void register_${name}\\(" LIMIT_COUNT 1)
    if(definition AND NOT file IN_LIST _CORE)
      string(APPEND declarations "void register_${name}(Registry<${_ENTRY}>&);\n")
      string(APPEND calls "  register_${name}(registry);\n")
    elseif(NOT file MATCHES "/" AND NOT file IN_LIST _CORE)
      message(FATAL_ERROR "${folder}/${file} must define register_${name}(Registry<${_ENTRY}>&); a file "
                          "that is not a component belongs in a subfolder or after CORE in "
                          "${folder}/CMakeLists.txt")
    endif()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/registry.cpp.in registry.cpp @ONLY)
  list(TRANSFORM files PREPEND ${path}/)
  set(${folder}_sources ${files} ${CMAKE_CURRENT_BINARY_DIR}/registry.cpp PARENT_SCOPE)
endfunction()

# isoline_components(folder …): builds the library isoline_<folder> from these sources.
function(isoline_components folder)
  isoline_registry(${folder} ${ARGN})
  add_library(isoline_${folder} STATIC ${${folder}_sources})
  add_library(Isoline::${folder} ALIAS isoline_${folder})
endfunction()
