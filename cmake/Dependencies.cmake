# Everything GraphDRL stands on, from Debian 12's packages. What each is for: README.md.
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Protobuf REQUIRED)
find_package(Boost 1.74 REQUIRED)

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

  find_package(Torch REQUIRED)
endif()
