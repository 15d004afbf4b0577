// oni_recorder OUT.oni FRAMES: records the test's camera with OpenNI 2 itself.
#include <OpenNI.h>

#include <cstdlib>
#include <iostream>
#include <string>

// The recorder's library leaks a little, and is unloaded before leaks can be suppressed by its
// name. NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" const char* __lsan_default_options() { return "detect_leaks=0"; }

namespace {

void Want(openni::Status status, const std::string& what) {
  if (status == openni::STATUS_OK) return;
  std::cerr << what << ": " << openni::OpenNI::getExtendedError() << "\n";
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  Want(openni::OpenNI::initialize(), "initialize");
  openni::Device device;
  Want(device.open("Test/Ramp"), "open");
  openni::VideoStream stream;
  Want(stream.create(device, openni::SENSOR_DEPTH), "create");
  openni::Recorder recorder;
  Want(recorder.create(argv[1]), "recorder");
  Want(recorder.attach(stream), "attach");
  Want(stream.start(), "start");
  Want(recorder.start(), "record");
  for (int i = 0; i < std::stoi(argv[2]); ++i) {
    openni::VideoFrameRef frame;
    Want(stream.readFrame(&frame), "read");
  }
  recorder.stop();
  recorder.destroy();
  stream.stop();
  stream.destroy();
  device.close();
  openni::OpenNI::shutdown();
  return 0;
}
