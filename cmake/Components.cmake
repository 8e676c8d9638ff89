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

# isoline_together(target groups...): compiles the files of each group at once, which parses their headers and
# instantiates their templates once. A group is a regular expression for paths without ".cpp". Other files, such as a
# new component, are compiled alone.
function(isoline_together target)
  if(NOT ISOLINE_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(group IN LISTS ARGN)
    string(SHA1 name ${group})
    string(SUBSTRING ${name} 0 8 name)
    foreach(source IN LISTS sources)
      if(source MATCHES "/(${group})\\.cpp$")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name})
      endif()
    endforeach()
  endforeach()
endfunction()
