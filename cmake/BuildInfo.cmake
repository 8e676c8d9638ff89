# Runs at every build. Writes the commit that is being built, whether the tree differs from it, and
# digests of the target's sources. The file changes only when these change, which avoids needless
# compilation.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
# Untracked files are listed below the working directory only, and SOURCE may be a part of the tree.
execute_process(COMMAND git rev-parse --show-toplevel WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT top)
  set(top ${SOURCE})
endif()
# The build also reads untracked files of these types.
set(read *.cpp *.h *.in *.cmake *CMakeLists.txt *.json *.js *.css *.html)
execute_process(COMMAND git status --porcelain --untracked-files=no WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE changes ERROR_QUIET)
execute_process(COMMAND git ls-files --others --exclude-standard -- ${read}
                WORKING_DIRECTORY ${top} OUTPUT_VARIABLE strangers ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
set(dirty "false")
if(changes OR strangers)
  set(dirty "true")
endif()

# digest_of(file out): a digest of the file and of everything that it includes with quotes, from its own
# folder or SOURCE.
function(digest_of file out)
  set(open ${file})
  set(found ${file})
  while(open)
    list(POP_BACK open one)
    cmake_path(GET one PARENT_PATH folder)
    file(STRINGS ${one} lines REGEX "^#include \"")
    list(TRANSFORM lines REPLACE "^#include \"([^\"]*)\".*" "\\1")
    foreach(line IN LISTS lines)
      foreach(next ${folder}/${line} ${SOURCE}/${line})
        if(EXISTS ${next} AND NOT next IN_LIST found)
          list(APPEND found ${next})
          list(APPEND open ${next})
          break()
        endif()
      endforeach()
    endforeach()
  endwhile()
  set(text "")
  foreach(one IN LISTS found)
    file(SHA256 ${one} digest)
    string(APPEND text ${digest})
  endforeach()
  string(SHA256 digest "${text}")
  string(SUBSTRING ${digest} 0 16 digest)
  set(${out} ${digest} PARENT_SCOPE)
endfunction()

set(sources "")
string(REPLACE "|" ";" files "${FILES}")
foreach(file IN LISTS files)
  cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${SOURCE} NORMALIZE OUTPUT_VARIABLE path)
  cmake_path(IS_PREFIX SOURCE ${path} is_ours)
  if(is_ours AND path MATCHES "\\.(cpp|cc|cxx)$" AND EXISTS ${path})
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${SOURCE} OUTPUT_VARIABLE name)
    digest_of(${path} digest)
    string(APPEND sources "${name} ${digest}\\n")
  endif()
endforeach()

file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#pragma once
inline constexpr const char* kCommit = "@commit@";
inline constexpr bool kDirty = @dirty@;
inline constexpr const char* kSources = "@sources@";
]])
