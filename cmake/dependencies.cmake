# Debian 12's packages; `./run deps` installs them.
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(absl REQUIRED)
find_package(Protobuf REQUIRED)
find_package(gRPC REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 2 REQUIRED)
find_package(RocksDB REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(Boost 1.74 REQUIRED)  # Asio and Beast, which are headers
pkg_check_modules(GRASPDB_ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(GRASPDB_PROMETHEUS REQUIRED IMPORTED_TARGET prometheus-cpp-core prometheus-cpp-pull)
pkg_check_modules(GRASPDB_JEMALLOC REQUIRED IMPORTED_TARGET jemalloc)

# FLANN's CMake config is not packaged; its header drags in lz4 for saved indices.
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
pkg_check_modules(GRASPDB_LZ4 REQUIRED IMPORTED_TARGET liblz4)
add_library(graspdb_flann INTERFACE)
target_include_directories(graspdb_flann SYSTEM INTERFACE ${FLANN_INCLUDE_DIR})
target_link_libraries(graspdb_flann INTERFACE PkgConfig::GRASPDB_LZ4)
