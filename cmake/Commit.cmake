# isoline_names_commit(target [WITHOUT_SOURCES]): writes "isoline_build_info.h" for the target at every
# build. It contains kCommit and kDirty of the repository of the target's CMakeLists.txt, and kSources: a
# line for each source of the target, with a digest of what it includes. At most one target per folder.
function(isoline_names_commit target)
  set(info ${CMAKE_CURRENT_BINARY_DIR}/isoline_build_info.h)
  if(NOT ARGN)
    set(files "$<JOIN:$<TARGET_PROPERTY:${target},SOURCES>,|>")
  endif()
  add_custom_target(${target}_commit BYPRODUCTS ${info} COMMENT "" VERBATIM
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR} -DOUTPUT=${info}
            "-DFILES=${files}"
            -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/BuildInfo.cmake)
  add_dependencies(${target} ${target}_commit)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
