// What an integrator writes in a config file to name a depth camera.
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
// "simulated", which has no target, "simulated:KEY=VALUE,KEY=VALUE". A key may stand without a
// value. A "?" in a path stays in it where what follows has a "/" or a ".".
struct SensorSpec {
  std::string kind;
  std::string target;
  std::map<std::string, std::string> options;
};

// INVALID_ARGUMENT when there is no kind, or an option is given twice or without a key. Which kinds
// there are is not looked at. Thread-safe.
absl::StatusOr<SensorSpec> ParseSensorSpec(const std::string& text);

// Takes the options of a spec one by one; remembers the first error. Not
// thread-safe.
class SensorOptions {
 public:
  explicit SensorOptions(const SensorSpec& spec) : rest_(spec.options) {}

  bool Flag(const std::string& key);
  std::string Text(const std::string& key, const std::string& otherwise);
  // Within [least, most].
  double Number(const std::string& key, double otherwise, double least, double most);
  // Whole, within [least, most].
  int Integer(const std::string& key, int otherwise, int least, int most);
  // A camera's fx, fy, cx and cy, pixels, all four or none; and width and height where they are not
  // those given here.
  std::optional<recognition::CameraIntrinsics> Intrinsics(int width, int height);
  std::uint64_t Seed(const std::string& key, std::uint64_t otherwise);
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
