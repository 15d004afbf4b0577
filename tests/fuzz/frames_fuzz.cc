// frames.json of a folder of real frames.
#include <google/protobuf/stubs/logging.h>

#include <cstdint>
#include <string>

#include "client/eval/frames_file.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

void Read(const std::string& text) {
  const auto frames = client::ParseFrames(text, "folder");
  if (!frames.ok()) return;
  for (const client::RealFrame& frame : *frames) {
    Require(!frame.path.empty(), "a frame has a file");
    for (const client::FrameObject& object : frame.objects) {
      Require(object.object.empty() == object.mesh.empty(), "what has a name has a mesh");
      if (!object.sensor_mesh) continue;
      Require(std::abs(object.sensor_mesh->linear().determinant() - 1) < 1e-9, "a rotation");
    }
  }
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
