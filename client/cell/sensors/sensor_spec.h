// Specifications of depth cameras in config files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// "KIND", "KIND:TARGET", "KIND?KEY=VALUE&KEY=VALUE" or "KIND:TARGET?KEY=VALUE&KEY=VALUE"; for
// "simulated", which has no target, "simulated:KEY=VALUE,KEY=VALUE". A key may have no
// value. A "?" belongs to the path if the text after it has a "/" or a ".".
struct SensorSpec {
  std::string kind;
  std::string target;
  std::map<std::string, std::string> options;
};

// INVALID_ARGUMENT when there is no kind, or an option is given twice or without a key. Does not
// check whether the kind exists. Thread-safe.
absl::StatusOr<SensorSpec> ParseSensorSpec(const std::string& text);

// Reads the options of a spec one by one; remembers the first error. Not thread-safe.
class SensorOptions {
 public:
  explicit SensorOptions(const SensorSpec& spec) : rest_(spec.options) {}

  bool Flag(const std::string& key);
  std::string Text(const std::string& key, const std::string& fallback);
  // Within [min, max].
  double Number(const std::string& key, double fallback, double min, double max);
  // Whole, within [min, max].
  int Integer(const std::string& key, int fallback, int min, int max);
  // A camera's fx, fy, cx and cy, pixels, all four or none; and width and height, which default to
  // the arguments.
  std::optional<recognition::CameraIntrinsics> Intrinsics(int width, int height);
  std::uint64_t Seed(const std::string& key, std::uint64_t fallback);
  // Separated by "+".
  std::vector<std::string> List(const std::string& key);

  // INVALID_ARGUMENT for the first invalid or unknown option.
  absl::Status Finish(const std::string& kind);

 private:
  std::optional<std::string> Take(const std::string& key);
  void Complain(const std::string& key, const std::string& what);

  std::map<std::string, std::string> rest_;
  std::vector<std::string> known_;
  std::string complaint_;
};

}  // namespace graspdb::client
