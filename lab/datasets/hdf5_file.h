// Numbers in HDF5 files; the one place where the HDF5 library is known.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb::client {

// The dataset `name` of the HDF5 file at `path`, as numbers of whatever type they are there.
// `rows` and `columns` are its shape; axes of length one may be left out or be more, so that a
// vector of n is n x 1 and a single number 1 x 1. Thread-safe; nothing is printed.
//
// NOT_FOUND when there is no such file or dataset; INVALID_ARGUMENT when it is no HDF5 file, no
// numbers, of another shape, or has a number that is not finite; DATA_LOSS when the file is cut
// short or damaged; each with the file, the dataset and what to do.
absl::StatusOr<Eigen::MatrixXd> ReadHdf5(const std::filesystem::path& path, const std::string& name,
                                         int rows, int columns);

}  // namespace graspdb::client
