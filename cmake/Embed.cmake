# isoline_embed(target name file): makes `file` part of the binary, as the text
# `std::string_view embedded_<name>()` in namespace isoline.
function(isoline_embed target name file)
  set(stem ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name})
  file(CONFIGURE OUTPUT ${stem}.S @ONLY CONTENT [[
    .section .rodata
    .global isoline_@name@_begin
    .global isoline_@name@_end
isoline_@name@_begin:
    .incbin "@file@"
isoline_@name@_end:
    .section .note.GNU-stack,"",%progbits
]])
  file(CONFIGURE OUTPUT ${stem}.cpp @ONLY CONTENT [[
#include <string_view>
extern "C" const char isoline_@name@_begin[], isoline_@name@_end[];
namespace isoline {
std::string_view embedded_@name@();
std::string_view embedded_@name@() {
  return {isoline_@name@_begin, static_cast<std::size_t>(isoline_@name@_end - isoline_@name@_begin)};
}
}  // namespace isoline
]])
  set_source_files_properties(${stem}.S PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${stem}.S ${stem}.cpp)
endfunction()
