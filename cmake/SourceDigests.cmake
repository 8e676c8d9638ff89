# cmake -DROOT=… -DOUTPUT=… -P SourceDigests.cmake
#
# Writes digests of the sources that compute a run, as the C++ function tree_sources(). "harness" is
# core/ without core/records/, and everything that benchmarks/run/execute.cpp reaches. Each file that
# registers components has a digest of itself and of everything else that it reaches.
#
# A file reaches the headers that it includes. A header reaches the file of the same name that implements
# it. A file without a header of its own implements the headers of its folder that it includes, so those
# headers reach it.
cmake_minimum_required(VERSION 3.25)
set(modules core networks problems optimizers benchmarks/plan benchmarks/run)

foreach(module IN LISTS modules)
  file(GLOB_RECURSE found RELATIVE ${ROOT} ${ROOT}/${module}/*.h ${ROOT}/${module}/*.cpp)
  list(APPEND files ${found})
endforeach()
list(FILTER files EXCLUDE REGEX "^core/records/")
list(SORT files)

foreach(file IN LISTS files)
  file(SHA256 ${ROOT}/${file} digest_of_${file})
  file(STRINGS ${ROOT}/${file} lines REGEX "^#include \"")
  list(TRANSFORM lines REPLACE "^#include \"([^\"]*)\".*" "\\1")
  set(included "")
  foreach(line IN LISTS lines)
    if(line IN_LIST files)
      list(APPEND included ${line})
    endif()
  endforeach()
  list(APPEND reached_by_${file} ${included})
  if(NOT file MATCHES "\\.cpp$")
    continue()
  endif()
  cmake_path(GET file STEM stem)
  file(STRINGS ${ROOT}/${file} definition REGEX "void (register|add)_${stem}\\(" LIMIT_COUNT 1)
  cmake_path(REPLACE_EXTENSION file .h OUTPUT_VARIABLE header)
  if(definition)
    list(APPEND components ${file})
  elseif(NOT header IN_LIST files)
    cmake_path(GET file PARENT_PATH folder)
    set(header ${included})
    list(FILTER header INCLUDE REGEX "^${folder}/[^/]*$")
    list(APPEND without_header ${file})
  endif()
  foreach(implemented IN LISTS header)
    list(APPEND reached_by_${implemented} ${file})
  endforeach()
endforeach()

# closure(out first...): these files and all files that they reach, sorted.
function(closure out)
  set(open ${ARGN})
  set(found ${ARGN})
  while(open)
    list(POP_BACK open file)
    foreach(next IN LISTS reached_by_${file})
      if(NOT next IN_LIST found)
        list(APPEND found ${next})
        list(APPEND open ${next})
      endif()
    endforeach()
  endwhile()
  list(SORT found)
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# add_entry(name files...): one line of the table.
function(add_entry name)
  set(text "")
  foreach(file IN LISTS ARGN)
    string(APPEND text "${file} ${digest_of_${file}}\n")
  endforeach()
  string(SHA256 digest "${text}")
  string(SUBSTRING ${digest} 0 16 digest)
  set(entries "${entries}      {\"${name}\", \"${digest}\"},\n" PARENT_SCOPE)
endfunction()

set(harness ${files})
list(FILTER harness INCLUDE REGEX "^core/")
closure(run_loop benchmarks/run/execute.cpp)
list(APPEND harness ${run_loop})
list(REMOVE_DUPLICATES harness)
list(SORT harness)
add_entry(harness ${harness})
foreach(component IN LISTS components)
  closure(parts ${component})
  list(REMOVE_ITEM parts ${harness})
  list(REMOVE_ITEM parts ${component})
  add_entry(${component} ${component} ${parts})
  list(APPEND digested ${component} ${parts})
endforeach()

# After an edit of a file without a digest, old records would be reused. A file with its own header that
# no component reaches takes no part in a run.
list(APPEND digested ${harness})
set(forgotten ${without_header})
list(FILTER forgotten INCLUDE REGEX "^(networks|problems|optimizers)/")
list(REMOVE_ITEM forgotten ${digested})
if(forgotten)
  message(FATAL_ERROR "No digest covers ${forgotten}: include the header in the same folder that "
                      "declares their functions, or give each a header of the same name.")
endif()

file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
// Generated from the sources: a digest of the sources of each component.
#include <map>
#include <string>

namespace isoline::benchmarks {

const std::map<std::string, std::string>& tree_sources();  // benchmarks/plan/catalog.h

const std::map<std::string, std::string>& tree_sources() {
  static const std::map<std::string, std::string> all{
@entries@  };
  return all;
}

}  // namespace isoline::benchmarks
]])
