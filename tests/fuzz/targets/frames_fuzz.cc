// frames.json of a folder of real frames.
#include <cstdint>
#include <string>

#include "lab/experiment/trials/frames_file.h"
#include "tests/fuzz/bytes_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

void Read(std::string_view text) {
  const auto frames = lab::ParseFrames(std::string(text), "folder");
  if (!frames.ok()) return;
  for (const lab::RealFrame& frame : *frames) {
    Require(!frame.path.empty(), "a frame has a file");
    for (const lab::FrameObject& object : frame.objects) {
      Require(object.object.empty() == object.mesh.empty(), "an object with a name has a mesh");
      if (!object.sensor_mesh) continue;
      Require(std::abs(object.sensor_mesh->linear().determinant() - 1) < 1e-9, "a rotation");
    }
  }
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_BYTES(graspdb::fuzz::Read)
