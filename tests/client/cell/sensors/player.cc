// player SPEC OUT FRAMES: asks the sensor SPEC for frames as an agent does, and tells on standard
// output what came: "frame N" for an image, which is written to OUT/N.png with its intrinsics
// beside it, or "error CODE: TEXT", once for all that follow with the same. It ends with FRAMES
// frames, or when the camera was gone for as many questions as kGoneForGood.
#include <iostream>
#include <string>

#include "absl/time/clock.h"
#include "client/cell/sensors/open_sensor.h"
#include "files/depth_message.h"
#include "files/depth_png.h"
#include "program/log.h"

namespace graspdb::client {
namespace {

constexpr int kGoneForGood = 20;
constexpr absl::Duration kTimeout = absl::Seconds(30);

absl::Status Keep(const std::string& folder, int number, const SensorFrame& frame) {
  const auto& image = std::get<v1::DepthImage>(frame.scan);
  const DepthPngCamera camera = {.intrinsics = FromMessage(image.intrinsics()),
                                 .depth_unit_m = DepthUnit(image)};
  absl::Status sidecar = WriteIntrinsics(folder + "/" + kIntrinsicsFile, camera);
  if (!sidecar.ok()) return sidecar;
  return WriteDepthPng(folder + "/" + std::to_string(number) + ".png", image);
}

int Play(const std::string& spec, const std::string& folder, int wanted) {
  SensorSettings settings;
  settings.first_pause = absl::Milliseconds(1);
  settings.longest_pause = absl::Milliseconds(10);
  const auto sensor = OpenSensor(spec, settings);
  if (!sensor.ok()) {
    std::cout << "error " << sensor.status() << std::endl;
    return 1;
  }
  std::string last;
  for (int frames = 0, gone = 0; frames < wanted && gone < kGoneForGood;) {
    const auto frame = (*sensor)->Next(absl::Now() + kTimeout);
    const absl::Status status = frame.ok() ? Keep(folder, frames, *frame) : frame.status();
    if (status.ok()) {
      std::cout << "frame " << frames++ << std::endl;
      gone = 0;
      last.clear();
      continue;
    }
    ++gone;
    if (status.ToString() != last) std::cout << "error " << status << std::endl;
    last = status.ToString();
    absl::SleepFor(absl::Milliseconds(10));
  }
  std::cout << "ready " << (*sensor)->IsReady() << std::endl;
  return 0;
}

}  // namespace
}  // namespace graspdb::client

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  graspdb::StartLog("player", "info");
  return graspdb::client::Play(argv[1], argv[2], std::stoi(argv[3]));
}
