# isoline_names_commit(target): writes "isoline_build_info.h" for the target at every build: kCommit
# and kDirty, of the repository that its CMakeLists.txt lies in. One target a folder.
function(isoline_names_commit target)
  set(info ${CMAKE_CURRENT_BINARY_DIR}/isoline_build_info.h)
  add_custom_target(${target}_commit BYPRODUCTS ${info} COMMENT ""
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR} -DOUTPUT=${info}
            -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/BuildInfo.cmake)
  add_dependencies(${target} ${target}_commit)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
