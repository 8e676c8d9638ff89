# isoline_embed(target name file...): embeds files, joined, in the binary, as the text
# `std::string_view embedded_<name>()` in the namespace of the target isoline_<module>.
function(isoline_embed target name)
  string(REPLACE "isoline_" "" module ${target})
  set(stem ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name})
  list(TRANSFORM ARGN REPLACE "(.+)" "    .incbin \"\\1\"" OUTPUT_VARIABLE parts)
  list(JOIN parts "\n" parts)
  file(CONFIGURE OUTPUT ${stem}.S @ONLY CONTENT [[
    .section .rodata
    .global isoline_@name@_begin
    .global isoline_@name@_end
isoline_@name@_begin:
@parts@
isoline_@name@_end:
    .section .note.GNU-stack,"",%progbits
]])
  file(CONFIGURE OUTPUT ${stem}.cpp @ONLY CONTENT [[
#include <string_view>
extern "C" const char isoline_@name@_begin[], isoline_@name@_end[];
namespace isoline::@module@ {
std::string_view embedded_@name@();
std::string_view embedded_@name@() {
  return {isoline_@name@_begin, static_cast<std::size_t>(isoline_@name@_end - isoline_@name@_begin)};
}
}  // namespace isoline::@module@
]])
  set_source_files_properties(${stem}.S PROPERTIES OBJECT_DEPENDS "${ARGN}")
  target_sources(${target} PRIVATE ${stem}.S ${stem}.cpp)
endfunction()

# isoline_embed_folder(target function folder [ending]): every *.json, or *.ending, of `folder`, by name, as
# `const std::map<std::string, std::string_view>& <function>()`.
function(isoline_embed_folder target function folder)
  string(REPLACE "isoline_" "" module ${target})
  set(ending json)
  if(ARGC GREATER 3)
    set(ending ${ARGV3})
  endif()
  file(GLOB files CONFIGURE_DEPENDS ${folder}/*.${ending})
  foreach(file IN LISTS files)
    cmake_path(GET file STEM stem)
    string(MAKE_C_IDENTIFIER "${function}_${stem}" name)
    isoline_embed(${target} ${name} ${file})
    string(APPEND declarations "std::string_view embedded_${name}();\n")
    string(APPEND entries "      {\"${stem}\", embedded_${name}()},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp @ONLY CONTENT [[
#include <map>
#include <string>
#include <string_view>
namespace isoline::@module@ {
@declarations@const std::map<std::string, std::string_view>& @function@();
const std::map<std::string, std::string_view>& @function@() {
  static const std::map<std::string, std::string_view> all{
@entries@  };
  return all;
}
}  // namespace isoline::@module@
]])
  target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
endfunction()
