#include "lab/datasets/hdf5_file.h"

#include <hdf5.h>

#include <mutex>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;

// Something of the library's that must be closed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (ok()) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  bool ok() const { return id_ >= 0; }
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// The library prints its complaints, with settings of each thread's own; ours are values.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

absl::Status Damaged(const std::string& what) {
  return absl::DataLossError(absl::StrCat(what, " is cut short or damaged; copy it again"));
}

absl::Status CheckIsHdf5(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return absl::NotFoundError(
        absl::StrCat(path.string(), " does not exist; copy it from the data set"));
  }
  if (H5Fis_hdf5(path.c_str()) <= 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is no HDF5 file; copy it again from the data set"));
  }
  return absl::OkStatus();
}

// The lengths of the axes that are longer than one.
std::vector<hsize_t> LongAxes(const std::vector<hsize_t>& shape) {
  std::vector<hsize_t> out;
  for (const hsize_t length : shape) {
    if (length != 1) out.push_back(length);
  }
  return out;
}

absl::Status CheckShape(const Handle& dataset, int rows, int columns, const std::string& what) {
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const H5T_class_t kind = type.ok() ? H5Tget_class(type.get()) : H5T_NO_CLASS;
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    return absl::InvalidArgumentError(absl::StrCat(what, " does not hold numbers; write some"));
  }
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const int axes = space.ok() ? H5Sget_simple_extent_ndims(space.get()) : -1;
  if (axes < 0) return Damaged(what);
  std::vector<hsize_t> shape(static_cast<std::size_t>(axes));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  // A dataset without any extent has no axes either, and holds nothing.
  const bool is_null = H5Sget_simple_extent_type(space.get()) == H5S_NULL;
  const std::vector<hsize_t> wanted = {static_cast<hsize_t>(rows), static_cast<hsize_t>(columns)};
  if (!is_null && LongAxes(shape) == LongAxes(wanted)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(what, " has the shape (",
                                                 is_null ? "nothing" : absl::StrJoin(shape, ", "),
                                                 "); it must be ", rows, " x ", columns));
}

}  // namespace

absl::StatusOr<Eigen::MatrixXd> ReadHdf5(const fs::path& path, const std::string& name, int rows,
                                         int columns) {
  // Not every build of the library may be called from several threads.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const Silence silence;
  if (absl::Status is = CheckIsHdf5(path); !is.ok()) return is;
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.ok()) return Damaged(path.string());
  const std::string what = absl::StrCat(path.string(), ": ", name);
  if (H5Lexists(file.get(), name.c_str(), H5P_DEFAULT) <= 0) {
    return absl::NotFoundError(absl::StrCat(what, " is not there; the file must have it"));
  }
  const Handle dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.ok()) return Damaged(what);
  if (absl::Status shape = CheckShape(dataset, rows, columns, what); !shape.ok()) return shape;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values(rows, columns);
  if (H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    return Damaged(what);
  }
  if (!values.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrCat(what, " has a number that is not finite; calibrate again"));
  }
  return Eigen::MatrixXd(values);
}

}  // namespace graspdb::client
