# cmake -DBUILD=… -DTREE=… -P installed_test.cmake
#
# Installs the build into a folder far from the tree and builds three repositories against the
# package: tests/cli/own, whose main() makes a catalog; clients/cpp, by isoline_program(); and what
# `isoline new` writes into an empty folder. Their programs have Isoline's verbs, their records name
# their repository's commit, and nothing of the tree or its build takes part.
set(temporary "$ENV{TMPDIR}")
if(NOT temporary)
  set(temporary /tmp)
endif()
string(RANDOM LENGTH 8 letters)
set(work ${temporary}/isoline-installed-${letters})
file(MAKE_DIRECTORY ${work})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${work} RESULT_VARIABLE result
                  OUTPUT_VARIABLE output ERROR_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT result EQUAL 0)
    file(REMOVE_RECURSE ${work})
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(fail)
  file(REMOVE_RECURSE ${work})
  message(FATAL_ERROR ${ARGV})
endfunction()

# build_apart(name): the repository work/<name> into work/<name>-build; every file that was read.
function(build_apart name)
  run(${CMAKE_COMMAND} -S ${name} -B ${name}-build -G Ninja -DCMAKE_PREFIX_PATH=${work}/prefix
      -DCMAKE_BUILD_TYPE=Debug)
  run(${CMAKE_COMMAND} --build ${name}-build)
  run(ninja -C ${name}-build -t deps)
  set(read "${output}")
  file(READ ${work}/${name}-build/build.ninja rules)
  foreach(far ${TREE}/ ${BUILD}/)
    foreach(text read rules)
      string(FIND "${${text}}" "${far}" at)
      if(NOT at EQUAL -1)
        string(SUBSTRING "${${text}}" ${at} 200 found)
        fail("the build of ${name} reads the tree: ${found}")
      endif()
    endforeach()
  endforeach()
endfunction()

function(commit name)
  run(git init --quiet ${name})
  run(git -C ${name} add .)
  run(git -C ${name} -c user.name=somebody -c user.email=somebody@example.org commit --quiet -m own)
  run(git -C ${name} rev-parse --short=12 HEAD)
  set(commit ${output} PARENT_SCOPE)
endfunction()

# expect_one_record(out commit): the one record in out/runs names the commit and no change of it.
function(expect_one_record out commit)
  file(GLOB records ${work}/${out}/runs/*.json)
  list(LENGTH records count)
  if(NOT count EQUAL 1)
    fail("expected one record in ${out}, found ${count}")
  endif()
  file(READ ${records} record)
  string(JSON found GET "${record}" provenance commit)
  string(JSON dirty GET "${record}" provenance dirty)
  if(NOT found STREQUAL commit OR dirty)
    fail("the record names commit ${found}, dirty ${dirty}; the repository's is ${commit}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)

foreach(file share/bash-completion/completions/isoline share/fish/vendor_completions.d/isoline.fish
             share/man/man1/isoline.1)
  file(SIZE ${work}/prefix/${file} size)
  if(size EQUAL 0)
    fail("${file} is empty")
  endif()
endforeach()

file(COPY ${TREE}/tests/cli/own/ DESTINATION ${work}/own)
commit(own)
build_apart(own)
run(own-build/isoline_own run --problem twist --optimizer newton --out out --quiet --no-report)
expect_one_record(out ${commit})

file(COPY ${TREE}/clients/cpp/ DESTINATION ${work}/cpp)
commit(cpp)
build_apart(cpp)
run(cpp-build/mine check freudenstein-roth)
run(cpp-build/mine audit polyak)
run(cpp-build/mine describe polyak)
run(cpp-build/mine run --problem freudenstein-roth --optimizer polyak --iterations 50 --out mine
    --no-report)
expect_one_record(mine ${commit})
run(cpp-build/mine report mine)
run(cpp-build/mine validate mine)

# From an empty folder, by the installed program itself; then a library in C by the installed header.
file(MAKE_DIRECTORY ${work}/begun)
run(${CMAKE_COMMAND} -E chdir begun ${work}/prefix/bin/isoline new problem my-chain)
run(${CMAKE_COMMAND} -E chdir begun ${work}/prefix/bin/isoline new optimizer my-method)
build_apart(begun)
run(begun-build/mine check my-chain)
run(begun-build/mine audit my-method)
run(begun-build/mine run --problem my-chain --optimizer levenberg-marquardt,my-method --out begun-out
    --quiet --no-report)
run(${CC} -I${work}/prefix/include -shared -fPIC -o rosenbrock.so ${TREE}/clients/c/rosenbrock.c)
run(begun-build/mine check rosenbrock-c --plugin ./rosenbrock.so)

# The client of Python is found beside the installed program.
find_program(python python3)
if(python)
  run(prefix/bin/isoline check
      "process[command=\"python3 prefix/share/isoline/python/examples/rosenbrock.py\"]")
endif()
file(REMOVE_RECURSE ${work})
