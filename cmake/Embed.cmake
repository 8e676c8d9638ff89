# isoline_embed(target name file...): embeds files, joined, in the binary, as the text
# `std::string_view embedded_<name>()` in the namespace of the target isoline_<module>. All texts of a
# target are two files of its build, which are written when its folder has been read.
function(isoline_embed target name)
  get_property(has_texts TARGET ${target} PROPERTY ISOLINE_TEXTS SET)
  if(NOT has_texts)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL isoline_write_embedded ${target})")
  endif()
  set_property(TARGET ${target} APPEND PROPERTY ISOLINE_TEXTS ${name})
  set_property(TARGET ${target} PROPERTY ISOLINE_TEXT_${name} ${ARGN})
endfunction()

# isoline_embed_folder(target function folder [ending]): every *.json, or *.ending, of `folder`, by name, as
# `const std::map<std::string, std::string_view>& <function>()`.
function(isoline_embed_folder target function folder)
  set(ending json)
  if(ARGC GREATER 3)
    set(ending ${ARGV3})
  endif()
  file(GLOB files CONFIGURE_DEPENDS ${folder}/*.${ending})
  foreach(file IN LISTS files)
    cmake_path(GET file STEM stem)
    string(MAKE_C_IDENTIFIER "${function}_${stem}" name)
    isoline_embed(${target} ${name} ${file})
    string(APPEND entries "      {\"${stem}\", embedded_${name}()},\n")
  endforeach()
  set_property(TARGET ${target} APPEND_STRING PROPERTY ISOLINE_FOLDERS
"const std::map<std::string, std::string_view>& ${function}();
const std::map<std::string, std::string_view>& ${function}() {
  static const std::map<std::string, std::string_view> all{
${entries}  };
  return all;
}
")
endfunction()

# isoline_write_embedded(target): the two files.
function(isoline_write_embedded target)
  string(REPLACE "isoline_" "" module ${target})
  get_target_property(names ${target} ISOLINE_TEXTS)
  get_property(folders TARGET ${target} PROPERTY ISOLINE_FOLDERS)
  foreach(name IN LISTS names)
    get_target_property(files ${target} ISOLINE_TEXT_${name})
    list(APPEND all ${files})
    set(begin isoline_${name}_begin)
    set(end isoline_${name}_end)
    list(TRANSFORM files REPLACE "(.+)" "    .incbin \"\\1\"\n")
    string(CONCAT parts ${files})
    string(APPEND texts "    .global ${begin}\n    .global ${end}\n${begin}:\n${parts}${end}:\n")
    string(APPEND functions "extern \"C\" const char ${begin}[], ${end}[];
std::string_view embedded_${name}();
std::string_view embedded_${name}() { return {${begin}, std::size_t(${end} - ${begin})}; }
")
  endforeach()
  set(stem ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  file(CONFIGURE OUTPUT ${stem}.S @ONLY CONTENT [[
    .section .rodata
@texts@    .section .note.GNU-stack,"",%progbits
]])
  file(CONFIGURE OUTPUT ${stem}.cpp @ONLY CONTENT [[
#include <map>
#include <string>
#include <string_view>
namespace isoline::@module@ {
@functions@@folders@}  // namespace isoline::@module@
]])
  set_source_files_properties(${stem}.S PROPERTIES OBJECT_DEPENDS "${all}")
  target_sources(${target} PRIVATE ${stem}.S ${stem}.cpp)
endfunction()
