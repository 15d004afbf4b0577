// Descriptions of capture sets, as text: mutates bytes or, every other time, fields of the parsed
// text.
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/capture_sets/capture_set.h"
#include "rendering/sample_parts.h"
#include "rendering/scene_file.h"
#include "tests/fuzz/message_mutator.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace graspdb::fuzz {
namespace {

namespace json = google::protobuf::util;

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {"bracket",  "flat", "top", "a.pcd",
                                                 "../a.pcd", "/a",   "",    "a-1"};
  return words;
}

void Read(std::string_view text) {
  static const ScratchFolder folder;
  static const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  folder.Write(files::kCaptureSetFile, text);
  if (const auto scene = rendering::ReadScene(folder.path(), parts); scene.ok()) {
    Require(scene->world_sensor.matrix().allFinite(), "a finite pose of the camera");
  }
  const auto set = files::LoadCaptureSet(folder.path());
  if (!set.ok()) return;
  const std::filesystem::path copy = folder.path() / "copy";
  Require(files::SaveCaptureSet(copy, *set).ok(), "parsed data can be written");
  const auto again = files::LoadCaptureSet(copy);
  Require(again.ok(), "written data can be read");
  Require(json::MessageDifferencer::Equals(*set, *again), "the same set after writing");
  Require(files::CapturesOf(*set).size() == static_cast<std::size_t>(set->captures_size()),
          "all captures");
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
  graspdb::v1::CaptureSet set;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (seed % 2 == 0 || !google::protobuf::util::JsonStringToMessage(text, &set).ok()) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  graspdb::fuzz::MessageMutator(seed, graspdb::fuzz::Words()).Mutate(set);
  std::string changed;
  if (!google::protobuf::util::MessageToJsonString(set, &changed).ok()) return 0;
  if (changed.size() > max_size) return 0;
  std::ranges::copy(changed, data);
  return changed.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
