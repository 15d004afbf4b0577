// The values of a camera file, whatever program wrote it; internal to the reader of depth images.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::files {

struct CameraEntry {
  std::string path;             // of its keys, for messages: "depth.scale"
  std::string name;             // of the last key, letters and digits in lower case: "scale"
  std::vector<double> numbers;  // of a number, a list, or a matrix row by row; else empty
  std::string text;             // of a string, or the first string of a list; else empty
};

// All values, in the order of their paths. The keys "data" and "values" only wrap the numbers of
// a matrix, so its own name is taken. INVALID_ARGUMENT, without the file's name, for objects that
// are nested deeper than any program nests a camera.
absl::StatusOr<std::vector<CameraEntry>> CameraEntriesOf(const google::protobuf::Struct& document);

}  // namespace graspdb::files
