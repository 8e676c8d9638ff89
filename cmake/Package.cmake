# In the portable build, `cpack` makes a Debian package of the program for machines without a compiler.
# It depends on the libraries that the program links.
install(TARGETS isoline COMPONENT program)

# Completions and the manual page, written by the installed program. Debian's zsh reads the
# completions of packages from a folder of their own.
set(zsh share/zsh/site-functions/_isoline)
if(ISOLINE_PORTABLE)
  set(zsh share/zsh/vendor-completions/_isoline)
endif()
foreach(file "completion;bash;share/bash-completion/completions/isoline" "completion;zsh;${zsh}"
             "completion;fish;share/fish/vendor_completions.d/isoline.fish"
             "man;share/man/man1/isoline.1")
  list(POP_BACK file path)
  install(CODE "
    set(file \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${path}\")
    get_filename_component(folder \"\${file}\" DIRECTORY)
    file(MAKE_DIRECTORY \"\${folder}\")
    execute_process(COMMAND \"$<TARGET_FILE:isoline>\" ${file} OUTPUT_FILE \"\${file}\"
                    COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
endforeach()
if(NOT ISOLINE_PORTABLE)  # a program for this machine's processor may not run on another
  return()
endif()

set(notice ${PROJECT_BINARY_DIR}/copyright)
file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
file(CONFIGURE OUTPUT ${notice} @ONLY CONTENT "This package holds the program isoline.

The program links FFTW and SuiteSparse (GNU General Public License, version 2 or later), the GNU
Scientific Library (version 3 or later) and oneDNN (Apache License 2.0). It is therefore, as a whole,
under the GNU General Public License, version 3 or later, whose text is
/usr/share/common-licenses/GPL-3 on a Debian system.
It also links libdogleg (GNU Lesser General Public License, version 3) and cminpack; MINPACK was developed by the University of Chicago, as Operator of Argonne
National Laboratory. The sources of Isoline alone are under the MIT license:

@license@")
install(FILES ${notice} DESTINATION share/doc/isoline COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME isoline)
set(CPACK_PACKAGE_CONTACT "the Isoline project <isoline@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Isoline runs optimizers on physical inverse problems. Each run has its own
process and writes one JSON record. Reports show rankings, profiles and
statistics. The program as a whole is under the GNU General Public License,
since it links FFTW and GSL.")
include(CPack)
