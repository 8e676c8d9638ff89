# cmake -DBUILD=… -DSOURCE=… -DWORK=… -P installed_test.cmake
#
# Installs the build and builds tests/cli/own against the package, in a repository of its own: the
# program has Isoline's verbs, and its records name that repository's commit.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result
                  OUTPUT_VARIABLE output ERROR_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(COPY ${SOURCE}/ DESTINATION ${WORK}/own)
run(git init --quiet own)
run(git -C own add .)
run(git -C own -c user.name=somebody -c user.email=somebody@example.org commit --quiet -m own)
run(git -C own rev-parse --short=12 HEAD)
set(commit ${output})

run(${CMAKE_COMMAND} -S own -B build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build build)
run(build/isoline_own run --problem twist --optimizer newton --out out --quiet --no-report)

file(GLOB records ${WORK}/out/runs/*.json)
list(LENGTH records count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "expected one record, found ${count}")
endif()
file(READ ${records} record)
string(JSON found GET "${record}" provenance commit)
string(JSON dirty GET "${record}" provenance dirty)
if(NOT found STREQUAL commit OR dirty)
  message(FATAL_ERROR "the record names commit ${found}, dirty ${dirty}; the repository's is ${commit}")
endif()

# The client of Python is found beside the installed program.
find_program(python python3)
if(python)
  run(prefix/bin/isoline check
      "process[command=\"python3 prefix/share/isoline/python/examples/rosenbrock.py\"]")
endif()
file(REMOVE_RECURSE ${WORK})
