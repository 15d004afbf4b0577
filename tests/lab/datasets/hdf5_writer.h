// Small HDF5 files for tests.
#pragma once

#include <hdf5.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace graspdb::client {

// A file that is open for writing; what it replaces is gone. A failure ends the test program.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& path) {
    std::filesystem::create_directories(path.parent_path());
    file_ = Checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  }
  ~Hdf5Writer() { H5Fclose(file_); }
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  // Row by row, in double precision.
  Hdf5Writer& Add(const std::string& name, const Eigen::MatrixXd& matrix) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
    return Add(name, {rows.rows(), rows.cols()}, H5T_NATIVE_DOUBLE, rows.data());
  }
  Hdf5Writer& Add(const std::string& name, int rows, int columns,
                  const std::vector<std::uint16_t>& image) {
    return Add(name, {rows, columns}, H5T_NATIVE_UINT16, image.data());
  }
  // Of any shape and type; `values` are as `type` says.
  Hdf5Writer& Add(const std::string& name, const std::vector<std::int64_t>& shape, hid_t type,
                  const void* values) {
    const std::vector<hsize_t> lengths(shape.begin(), shape.end());
    const hid_t space =
        Checked(H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), nullptr));
    const hid_t dataset = Checked(
        H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    Checked(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    H5Dclose(dataset);
    H5Sclose(space);
    return *this;
  }

 private:
  template <typename T>
  static T Checked(T result) {
    if (result < 0) std::abort();
    return result;
  }

  hid_t file_ = H5I_INVALID_HID;
};

}  // namespace graspdb::client
