// player SPEC OUT FRAMES: reads frames from the sensor SPEC like an agent, and prints the results:
// "frame N" for an image, which is written to OUT/N.png with its intrinsics in the same folder, or
// "error CODE: TEXT", once for repeated errors. Ends after FRAMES frames, or after kMaxErrors
// errors in a row.
#include <cstdio>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "program/log/log.h"

namespace graspdb::client {
namespace {

constexpr int kMaxErrors = 300;  // 3 s: a camera that is plugged in again opens within 0.5 s
constexpr absl::Duration kTimeout = absl::Seconds(30);

absl::Status Keep(const std::string& folder, int number, const SensorFrame& frame) {
  const auto& image = std::get<v1::DepthImage>(frame.scan);
  const files::DepthPngCamera camera = {.intrinsics = files::FromMessage(image.intrinsics()),
                                        .depth_unit_m = files::DepthUnit(image)};
  absl::Status sidecar = files::WriteIntrinsics(folder + "/" + files::kIntrinsicsFile, camera);
  if (!sidecar.ok()) return sidecar;
  return files::WriteDepthPng(folder + "/" + std::to_string(number) + ".png", image);
}

// In one write: fakenect prints to the same stream from the sensor's thread.
void Print(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

int Play(const std::string& spec, const std::string& folder, int count) {
  SensorSettings settings;
  settings.first_pause = absl::Milliseconds(1);
  settings.max_pause = absl::Milliseconds(10);
  const auto sensor = OpenSensor(spec, settings);
  if (!sensor.ok()) {
    Print(absl::StrCat("error ", sensor.status().ToString()));
    return 1;
  }
  std::string last;
  for (int frames = 0, errors = 0; frames < count && errors < kMaxErrors;) {
    const auto frame = (*sensor)->Next(MonotonicTime::Now() + kTimeout);
    const absl::Status status = frame.ok() ? Keep(folder, frames, *frame) : frame.status();
    if (status.ok()) {
      Print(absl::StrCat("frame ", frames++));
      errors = 0;
      last.clear();
      continue;
    }
    ++errors;
    if (status.ToString() != last) Print(absl::StrCat("error ", status.ToString()));
    last = status.ToString();
    absl::SleepFor(absl::Milliseconds(10));
  }
  Print(absl::StrCat("ready ", (*sensor)->IsReady()));
  return 0;
}

}  // namespace
}  // namespace graspdb::client

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  graspdb::StartLog("player", "info");
  return graspdb::client::Play(argv[1], argv[2], std::stoi(argv[3]));
}
