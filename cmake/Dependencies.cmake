# All libraries of the project. CMake finds them on the system and downloads nothing.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt 9 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(NLopt 2.7 REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB 1.2 REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)

# isoline_library(target names header version): an imported target for a library without a package.
function(isoline_library target names header)
  string(MAKE_C_IDENTIFIER "${target}" id)
  find_path(${id}_INCLUDE ${header} PATH_SUFFIXES ${ARGN} REQUIRED)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${${id}_INCLUDE})
  foreach(name IN LISTS names)
    find_library(${id}_${name} ${name} REQUIRED)
    target_link_libraries(${target} INTERFACE ${${id}_${name}})
  endforeach()
endfunction()

# Named directly, not through the system's BLAS alternatives, which differ between machines.
isoline_library(Isoline::lapacke "openblas;lapacke" lapacke.h)
isoline_library(Isoline::cholmod "cholmod" suitesparse/cholmod.h)
isoline_library(Isoline::fftw "fftw3" fftw3.h)
isoline_library(Isoline::onednn "dnnl" oneapi/dnnl/dnnl.hpp)  # its own package requires OpenCL
isoline_library(Isoline::random123 "" Random123/philox.h)
isoline_library(Isoline::cminpack "cminpack" cminpack.h cminpack-1)
isoline_library(Isoline::libdogleg "dogleg" dogleg.h)
# Without gslcblas, which GSL loads itself: linked before OpenBLAS, its slow cblas_dgemm would be ours.
isoline_library(Isoline::gsl "gsl" gsl/gsl_multifit_nlinear.h)
isoline_library(Isoline::simdjson "simdjson" simdjson.h)
isoline_library(Isoline::valijson "" valijson/validator.hpp)

# Ceres' CMake target is the static library. It is built for other vector instructions, and the linker
# would merge its inline Eigen functions with ours. The shared library keeps its own.
isoline_library(Isoline::ceres "libceres.so;glog" ceres/ceres.h)
find_package(Ceres 2.1 REQUIRED)

# The library versions that each record names.
file(STRINGS ${Isoline__onednn_INCLUDE}/oneapi/dnnl/dnnl_version.h _lines REGEX "VERSION_(MAJOR|MINOR|PATCH) ")
string(REGEX REPLACE "[^0-9;]" "" _lines "${_lines}")
list(JOIN _lines "." _onednn)
find_file(ISOLINE_OPENBLAS_CONFIG openblas_config.h REQUIRED)
file(STRINGS ${ISOLINE_OPENBLAS_CONFIG} _lines REGEX "OPENBLAS_VERSION")
string(REGEX MATCH "[0-9]+[0-9.]*" _openblas "${_lines}")
file(SHA256 ${Isoline__random123_INCLUDE}/Random123/philox.h _philox)  # its headers have no version
string(SUBSTRING ${_philox} 0 8 _philox)
file(STRINGS ${Isoline__gsl_INCLUDE}/gsl/gsl_version.h _lines REGEX "define GSL_VERSION")
string(REGEX MATCH "[0-9][0-9.]*" _gsl "${_lines}")
file(REAL_PATH ${Isoline__cminpack_cminpack} _cminpack)  # only the name of the file has its version
string(REGEX MATCH "[0-9]+\\.[0-9.]+$" _cminpack ${_cminpack})
file(REAL_PATH ${Isoline__libdogleg_dogleg} _dogleg)
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+$" _dogleg ${_dogleg})
set(ISOLINE_LIBRARIES "Eigen ${Eigen3_VERSION}" "Ceres ${Ceres_VERSION}" "NLopt ${NLopt_VERSION}"
    "nlohmann-json ${nlohmann_json_VERSION}" "fmt ${fmt_VERSION}"
    "oneDNN ${_onednn}" "OpenBLAS ${_openblas}" "Random123 ${_philox}" "GSL ${_gsl}" "cminpack ${_cminpack}"
    "libdogleg ${_dogleg}")
