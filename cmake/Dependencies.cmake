# Everything GraphDRL stands on, from Debian 12's packages. What each is for: docs/dependencies.md.
function(require found what debian)
  if(NOT found) # empty, FALSE or NOTFOUND
    message(FATAL_ERROR "${what} not found: install Debian's ${debian}; scripts/setup installs all that is needed")
  endif()
endfunction()

macro(require_package name debian)
  find_package(${name} ${ARGN} QUIET)
  require("${${name}_FOUND}" ${name} ${debian})
endmacro()

require_package(TBB libtbb-dev)
require_package(fmt libfmt-dev)
require_package(nlohmann_json nlohmann-json3-dev)
require_package(CLI11 libcli11-dev)
require_package(PNG libpng-dev)
require_package(ZLIB zlib1g-dev)
require_package(pugixml libpugixml-dev)
require_package(yaml-cpp libyaml-cpp-dev)
require_package(Protobuf "libprotobuf-dev and protobuf-compiler")
require_package(Boost libboost-dev 1.74)

# Cairo brings no CMake package.
find_path(CAIRO_INCLUDE_DIR cairo.h PATH_SUFFIXES cairo)
find_library(CAIRO_LIBRARY cairo)
require("${CAIRO_INCLUDE_DIR}" Cairo libcairo2-dev)
add_library(graphdrl_cairo INTERFACE)
target_include_directories(graphdrl_cairo SYSTEM INTERFACE ${CAIRO_INCLUDE_DIR})
target_link_libraries(graphdrl_cairo INTERFACE ${CAIRO_LIBRARY})

# xxHash's header alone is used.
find_path(LEMON_INCLUDE_DIR lemon/matching.h)
require("${LEMON_INCLUDE_DIR}" LEMON liblemon-dev)

find_path(XXHASH_INCLUDE_DIR xxhash.h)
require("${XXHASH_INCLUDE_DIR}" xxHash libxxhash-dev)

# Chart.js, for the report page.
find_file(CHART_LIBRARY chart.min.js PATHS /usr/share/javascript/chart.js)
require("${CHART_LIBRARY}" Chart.js libjs-chart.js)

# The schema of ONNX's files.
find_file(ONNX_PROTO onnx.proto PATH_SUFFIXES onnx PATHS /usr/include)
require("${ONNX_PROTO}" "ONNX's schema" libonnx-dev)

# CLP (EPL-2.0) is optional: without it bounds are those of planners/bound.h. Not by pkg-config's flags, which would link
# the programs with a LAPACK of the linker's choice.
if(GRAPHDRL_CLP)
  find_path(CLP_INCLUDE_DIR ClpSimplex.hpp PATH_SUFFIXES coin)
  find_library(CLP_LIBRARY Clp)
  find_library(COIN_UTILS_LIBRARY CoinUtils)
  if(CLP_INCLUDE_DIR AND CLP_LIBRARY AND COIN_UTILS_LIBRARY)
    add_library(graphdrl_clp INTERFACE)
    target_include_directories(graphdrl_clp SYSTEM INTERFACE ${CLP_INCLUDE_DIR})
    target_link_libraries(graphdrl_clp INTERFACE ${CLP_LIBRARY} ${COIN_UTILS_LIBRARY})
  else()
    message(STATUS "CLP not found: built without bounds by linear programming")
  endif()
endif()

if(GRAPHDRL_MPI)
  # MPI's C interface. Not MPI_CXX, whose C++ bindings are older than C++20.
  enable_language(C)
  find_package(MPI QUIET COMPONENTS C)
  require("${MPI_C_FOUND}" MPI "libopenmpi-dev and openmpi-bin (scripts/setup --mpi)")
  add_library(graphdrl_mpi_library INTERFACE)
  target_link_libraries(graphdrl_mpi_library INTERFACE MPI::MPI_C)
endif()

if(GRAPHDRL_TORCH)
  # LibTorch's BLAS: OpenBLAS's OpenMP build and no other; with the pthread build its thread pool fights OpenMP's.
  # Debian keeps each build in a folder of its own. The programs look there first (DT_RPATH, which, unlike DT_RUNPATH,
  # also holds for the libblas.so.3 that LibTorch asks for), whatever the system's alternatives say.
  find_path(OPENBLAS_INCLUDE_DIR cblas.h
    PATH_SUFFIXES ${CMAKE_LIBRARY_ARCHITECTURE}/openblas-openmp openblas-openmp REQUIRED)
  find_library(OPENBLAS_LIBRARY openblas PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/openblas-openmp
    NO_DEFAULT_PATH)
  if(NOT OPENBLAS_LIBRARY)
    message(FATAL_ERROR
      "OpenBLAS's OpenMP build not found: install libopenblas-openmp-dev (scripts/setup --torch does)")
  endif()
  get_filename_component(OPENBLAS_DIR ${OPENBLAS_LIBRARY} DIRECTORY)
  add_library(graphdrl_blas INTERFACE)
  target_include_directories(graphdrl_blas SYSTEM INTERFACE ${OPENBLAS_INCLUDE_DIR})
  target_link_libraries(graphdrl_blas INTERFACE ${OPENBLAS_LIBRARY})
  set(CMAKE_BUILD_RPATH ${OPENBLAS_DIR})
  set(CMAKE_INSTALL_RPATH ${OPENBLAS_DIR})
  add_link_options(LINKER:--disable-new-dtags)

  # A LibTorch with CUDA enables CMake's language CUDA and looks for this machine's GPU. No file here is in that
  # language, and no GPU is needed to build.
  set(CMAKE_CUDA_STANDARD 17)
  set(TORCH_CUDA_ARCH_LIST 9.0)
  # Here alone: a LibTorch of a Python wheel has headers of other libraries beside its own.
  set(prefix_path ${CMAKE_PREFIX_PATH})
  list(PREPEND CMAKE_PREFIX_PATH ${GRAPHDRL_LIBTORCH})
  find_package(Torch REQUIRED)
  cmake_path(IS_PREFIX GRAPHDRL_LIBTORCH "${Torch_DIR}" found_there)
  if(GRAPHDRL_LIBTORCH AND NOT found_there)
    message(FATAL_ERROR "this build folder has LibTorch from ${Torch_DIR}: configure it anew (cmake --fresh)")
  endif()
  set(CMAKE_PREFIX_PATH ${prefix_path})
endif()
