# readme_examples(out): cuts the ```cpp blocks out of README.md and docs/, each into the file its first
# line names, and writes a function that registers the optimizers, and the catalog that holds them all.
# `out` receives the sources to compile.
function(readme_examples out)
  file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/*.md)
  list(PREPEND pages ${PROJECT_SOURCE_DIR}/README.md)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${pages})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/readme)
  set(text "")
  foreach(page IN LISTS pages)
    file(READ ${page} one)
    string(APPEND text "${one}")
  endforeach()
  set(sources ${folder}/catalog.cpp ${folder}/optimizers.cpp)
  set(registry_of_problems ProblemRegistry)
  set(registry_of_optimizers OptimizerRegistry)
  set(fence "```cpp\n")
  string(LENGTH "${fence}" fence_length)
  while(TRUE)
    string(FIND "${text}" "${fence}" begin)
    if(begin EQUAL -1)
      break()
    endif()
    math(EXPR begin "${begin} + ${fence_length}")
    string(SUBSTRING "${text}" ${begin} -1 text)
    string(FIND "${text}" "\n```" end)
    math(EXPR end "${end} + 1")
    string(SUBSTRING "${text}" 0 ${end} block)
    string(SUBSTRING "${text}" ${end} -1 text)
    if(NOT block MATCHES "^// ((problems|optimizers)/([a-z0-9_]+)\\.cpp)")
      message(FATAL_ERROR "README.md, docs/: line one of a cpp block must be // problems/NAME.cpp or "
                          "// optimizers/NAME.cpp")
    endif()
    set(room ${CMAKE_MATCH_2})
    set(file ${folder}/${CMAKE_MATCH_1})
    set(name ${CMAKE_MATCH_3})
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${room}/${name}.cpp)  # else a reader has saved the example there
      file(CONFIGURE OUTPUT ${file} CONTENT "${block}" @ONLY)
      list(APPEND sources ${file})
      string(APPEND ${room}_declarations "void register_${name}(${registry_of_${room}}&);\n")
      string(APPEND ${room}_calls "  register_${name}(registry);\n")
    endif()
    string(REPLACE "_" "-" entry ${name})
    string(APPEND ${room}_names "\"${entry}\", ")
  endwhile()
  file(CONFIGURE OUTPUT ${folder}/optimizers.cpp CONTENT
"// Generated from the cpp blocks of README.md and docs/.
#include \"optimizers/optimizer.h\"

namespace isoline::optimizers {
@optimizers_declarations@
void register_readme_examples(OptimizerRegistry& registry);
void register_readme_examples([[maybe_unused]] OptimizerRegistry& registry) {
@optimizers_calls@}

}  // namespace isoline::optimizers
" @ONLY)
  file(CONFIGURE OUTPUT ${folder}/catalog.cpp CONTENT
"// Generated from the cpp blocks of README.md and docs/.
#include \"benchmarks/plan/catalog.h\"
#include \"optimizers/optimizer.h\"
#include \"problems/problem.h\"

namespace isoline::problems {
@problems_declarations@
static void register_readme_examples([[maybe_unused]] ProblemRegistry& registry) {
@problems_calls@}

}  // namespace isoline::problems

namespace isoline::optimizers {
void register_readme_examples(OptimizerRegistry& registry);
}

namespace isoline::benchmarks {

Catalog catalog_with_readme_examples() {
  Catalog catalog = builtin_catalog();
  problems::register_readme_examples(catalog.problems);
  optimizers::register_readme_examples(catalog.optimizers);
  return catalog;
}

std::vector<std::string> readme_problems() { return {@problems_names@}; }
std::vector<std::string> readme_optimizers() { return {@optimizers_names@}; }

}  // namespace isoline::benchmarks
" @ONLY)
  set(${out} ${sources} PARENT_SCOPE)
endfunction()
