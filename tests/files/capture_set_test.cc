#include "files/capture_sets/capture_set.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/files/temporary_folder.h"
#include "tests/testing/unreadable_folder.h"

namespace graspdb::files {
namespace {

using testing::HasSubstr;

v1::CaptureSet Mustard() {
  v1::CaptureSet set;
  v1::CapturedObject* object = set.add_objects();
  object->set_object_id("mustard");
  object->set_mesh_path("models/mustard.ply");
  v1::CapturedStablePose* pose = object->add_stable_poses();
  pose->set_stable_pose_id("upright");
  pose->set_symmetry_order(0);
  v1::Grasp* grasp = pose->add_grasps();
  grasp->set_grasp_id("top");
  grasp->mutable_tcp_pose()->mutable_orientation()->set_x(1);
  set.mutable_region_of_interest()->mutable_max()->set_x(0.3);
  for (const auto split : {v1::Capture::TEACH, v1::Capture::QUERY}) {
    v1::Capture* capture = set.add_captures();
    capture->set_path("clouds/" + std::to_string(set.captures_size()) + ".pcd");
    capture->set_split(split);
    capture->set_object_id("mustard");
    capture->set_stable_pose_id("upright");
    capture->mutable_object_pose()->mutable_orientation()->set_w(1);
  }
  return set;
}

TEST(CaptureSet, RoundTripKeepsEverythingIncludingAZeroSymmetryOrder) {
  const TemporaryFolder folder;
  ASSERT_TRUE(SaveCaptureSet(folder.path() / "new", Mustard()).ok());
  const auto loaded = LoadCaptureSet(folder.path() / "new");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(*loaded, Mustard()));
  EXPECT_TRUE(loaded->objects(0).stable_poses(0).has_symmetry_order());
  const std::string text = BytesOf(folder.path() / "new" / "captures.json");
  EXPECT_THAT(text, HasSubstr("\n     \"stablePoseId\"")) << "not indented";
  EXPECT_THAT(text, HasSubstr("\"split\": \"TEACH\""));
  EXPECT_THAT(text, testing::Not(HasSubstr("segmented"))) << "defaults are left out";
}

TEST(CaptureSet, UnknownFieldsAreIgnored) {
  const TemporaryFolder folder;
  folder.Write("captures.json", R"({"captures": [{"path": "a.pcd", "colour": {"r": 1}}]})");
  const auto loaded = LoadCaptureSet(folder.path());
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->captures(0).path(), "a.pcd");
}

TEST(CaptureSet, MissingFileAndBadJsonErrorsNameThePlace) {
  const TemporaryFolder folder;
  const auto missing = LoadCaptureSet(folder.path());
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.status().message()), HasSubstr("captures.json does not exist"));

  folder.Write("captures.json", "{\n  \"captures\": [\n    {\"path\" \"a.pcd\"}\n  ]\n}\n");
  const auto bad = LoadCaptureSet(folder.path());
  EXPECT_EQ(bad.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(bad.status().message()), HasSubstr("at line 3, column 13"));
  EXPECT_THAT(std::string(bad.status().message()), testing::Not(HasSubstr("\n")));

  folder.Write("captures.json", R"({"captures": [{"path": {"a": 1}}]})");
  const auto wrong_type = LoadCaptureSet(folder.path());
  EXPECT_THAT(std::string(wrong_type.status().message()), HasSubstr("captures[0]"));

  folder.Write("captures.json", "");
  EXPECT_EQ(LoadCaptureSet(folder.path()).status().code(), absl::StatusCode::kInvalidArgument);
  std::filesystem::remove(folder.path() / "captures.json");
  std::filesystem::create_directories(folder.path() / "captures.json");
  EXPECT_EQ(LoadCaptureSet(folder.path()).status().code(), absl::StatusCode::kFailedPrecondition);
}

// The words of other dialects of JSON.
TEST(CaptureSet, WhatHasTwoMeaningsOrNoneIsRejected) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    folder.Write("captures.json", text);
    return std::string(LoadCaptureSet(folder.path()).status().message());
  };
  EXPECT_THAT(error_of("// mine\n{}"), HasSubstr("line 1, column 1"));
  EXPECT_THAT(error_of("{\n \"captures\": [] # mine\n}"), HasSubstr("line 2, column 17"));
  EXPECT_THAT(error_of("{\"regionOfInterest\": {\"max\": {\"x\": NaN}}}"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("{\"regionOfInterest\": {\"max\": {\"x\": 0,3}}}"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("{}\n{}"), HasSubstr("line 2, column 1"));
  EXPECT_THAT(error_of("{\"captures\": [{\"path\": \"a\",\n\"path\": \"b\"}]}"),
              HasSubstr("\"path\" is twice in one object, again in line 2"));
}

TEST(CaptureSet, WhatHasOneMeaningIsRead) {
  const TemporaryFolder folder;
  for (const char* text : {"{'captures': [{'path': 'a.pcd'}]}", "{captures: [{path: \"a.pcd\"}]}",
                           "{\"captures\": [{\"path\": \"a.pcd\",}],}"}) {
    folder.Write("captures.json", text);
    const auto set = LoadCaptureSet(folder.path());
    ASSERT_TRUE(set.ok()) << text << set.status();
    EXPECT_EQ(set->captures(0).path(), "a.pcd") << text;
  }
}

// As editors and shells of Windows write it.
TEST(CaptureSet, AByteOrderMarkIsSkippedAndUtf16IsNamed) {
  const TemporaryFolder folder;
  folder.Write("captures.json", "\xEF\xBB\xBF{\"captures\": [{\"path\": \"a.pcd\"}]}\r\n");
  const auto set = LoadCaptureSet(folder.path());
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->captures_size(), 1);
  folder.Write("captures.json", std::string("\xFF\xFE{\0}\0", 6));
  EXPECT_THAT(std::string(LoadCaptureSet(folder.path()).status().message()),
              HasSubstr("captures.json has the encoding UTF-16"));
}

TEST(CaptureSet, AFolderOrFileThatMayNotBeReadIsNotReportedAsMissing) {
  using std::filesystem::perms;
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.Write("captures.json", "{}");
  const auto expect_denied = [&] {
    EXPECT_THAT(std::string(LoadCaptureSet(folder.path()).status().message()),
                HasSubstr("captures.json cannot be read (Permission denied)"));
  };
  {
    const UnreadableFolder unreadable(folder.path(), perms::none);
    expect_denied();
  }
  std::filesystem::permissions(file, perms::none);
  std::filesystem::create_directory(folder.path() / "other");
  folder.Write("other/any", "");
  const UnreadableFolder without_capabilities(folder.path() / "other");
  expect_denied();
}

struct Broken {
  const char* what;
  std::function<void(v1::CaptureSet&)> how;
};

TEST(CaptureSet, ViolationsAreReportedWithThePlaceOnLoadAndSave) {
  const Broken broken[] = {
      {"captures[1].path is missing", [](auto& s) { s.mutable_captures(1)->clear_path(); }},
      {"captures[0].path \"../a.pcd\" leads out",
       [](auto& s) { s.mutable_captures(0)->set_path("../a.pcd"); }},
      {"captures[0].path \"clouds/../../a.pcd\" leads out",
       [](auto& s) { s.mutable_captures(0)->set_path("clouds/../../a.pcd"); }},
      {"captures[0].path \"/etc/a.pcd\" leads out",
       [](auto& s) { s.mutable_captures(0)->set_path("/etc/a.pcd"); }},
      {"objects[0].meshPath \"../m.ply\"",
       [](auto& s) { s.mutable_objects(0)->set_mesh_path("../m.ply"); }},
      {"captures[0] has the split TEACH",
       [](auto& s) { s.mutable_captures(0)->clear_stable_pose_id(); }},
      {"captures[0] has the split TEACH",
       [](auto& s) { s.mutable_captures(0)->clear_object_id(); }},
      {"captures[1].objectId \"ketchup\" is not in objects",
       [](auto& s) { s.mutable_captures(1)->set_object_id("ketchup"); }},
      {"captures[1].stablePoseId \"lying\" is not among",
       [](auto& s) { s.mutable_captures(1)->set_stable_pose_id("lying"); }},
      {"captures[1].objectPose.orientation has the norm 1.002",
       [](auto& s) {
         s.mutable_captures(1)->mutable_object_pose()->mutable_orientation()->set_w(1.002);
       }},
      {"captures[1].sensorPose.orientation has the norm 0",
       [](auto& s) { s.mutable_captures(1)->mutable_sensor_pose(); }},
      {"captures[1].objectPose has a number that is not finite",
       [](auto& s) {
         s.mutable_captures(1)->mutable_object_pose()->mutable_position()->set_x(std::nan(""));
       }},
      {"objects[1].objectId \"mustard\" is used twice",
       [](auto& s) { *s.add_objects() = s.objects(0); }},
      {"objects[0].stablePoses[0].stablePoseId is missing",
       [](auto& s) { s.mutable_objects(0)->mutable_stable_poses(0)->clear_stable_pose_id(); }},
      {"objects[0].stablePoses[0].symmetryOrder is -1",
       [](auto& s) { s.mutable_objects(0)->mutable_stable_poses(0)->set_symmetry_order(-1); }},
      {"objects[0].stablePoses[0].minScore is 2",
       [](auto& s) { s.mutable_objects(0)->mutable_stable_poses(0)->set_min_score(2); }},
      {"objects[0].stablePoses[0].grasps[0].tcpPose",
       [](auto& s) {
         s.mutable_objects(0)->mutable_stable_poses(0)->mutable_grasps(0)->clear_tcp_pose();
       }},
      {"regionOfInterest",
       [](auto& s) { s.mutable_region_of_interest()->mutable_min()->set_x(0.4); }}};
  const TemporaryFolder folder;
  for (const Broken& rule : broken) {
    v1::CaptureSet set = Mustard();
    rule.how(set);
    const absl::Status saved = SaveCaptureSet(folder.path(), set);
    EXPECT_EQ(saved.code(), absl::StatusCode::kInvalidArgument) << rule.what;
    EXPECT_THAT(std::string(saved.message()), HasSubstr(rule.what));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "captures.json"));

  folder.Write("captures.json", R"({"captures": [{"path": "a.pcd", "split": "TEACH"}]})");
  const auto loaded = LoadCaptureSet(folder.path());
  EXPECT_THAT(
      std::string(loaded.status().message()),
      testing::AllOf(HasSubstr("captures.json"), HasSubstr("captures[0] has the split TEACH")));
}

TEST(CaptureSet, AMisspeltSplitIsRejected) {
  const TemporaryFolder folder;
  folder.Write("captures.json", R"({"captures": [{"path": "a.pcd"},
      {"path": "b.pcd", "split": "QUERRY"}]})");
  const auto loaded = LoadCaptureSet(folder.path());
  EXPECT_EQ(loaded.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(loaded.status().message()), HasSubstr("captures[1].split is \"QUERRY\""));
}

// Written nevertheless: an export includes whatever a server was taught.
TEST(CaptureSet, PosesInMillimetresAreRejectedOnLoad) {
  const TemporaryFolder folder;
  v1::CaptureSet set = Mustard();
  v1::Capture* capture = set.mutable_captures(1);
  capture->mutable_sensor_pose()->mutable_orientation()->set_w(1);
  capture->mutable_object_pose()->mutable_position()->set_z(99);
  ASSERT_TRUE(SaveCaptureSet(folder.path(), set).ok());
  EXPECT_TRUE(LoadCaptureSet(folder.path()).ok());
  capture->mutable_object_pose()->mutable_position()->set_z(800);
  ASSERT_TRUE(SaveCaptureSet(folder.path(), set).ok());
  const auto loaded = LoadCaptureSet(folder.path());
  EXPECT_EQ(loaded.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(loaded.status().message()),
              HasSubstr("captures[1].objectPose is 800 m from sensorPose"));
}

TEST(CaptureSet, QueriesMayShowUnknownObjects) {
  v1::CaptureSet set = Mustard();
  set.mutable_captures(1)->clear_object_id();
  set.mutable_captures(1)->clear_stable_pose_id();
  const TemporaryFolder folder;
  EXPECT_TRUE(SaveCaptureSet(folder.path(), set).ok());
}

TEST(CaptureSet, CapturesOfASplitIncludeThoseForEither) {
  v1::CaptureSet set = Mustard();
  *set.add_captures() = set.captures(0);
  set.mutable_captures(2)->clear_split();
  set.add_captures()->set_path("unnamed.pcd");
  EXPECT_THAT(CapturesOf(set, v1::Capture::TEACH),
              testing::ElementsAre(&set.captures(0), &set.captures(2)));
  EXPECT_THAT(CapturesOf(set, v1::Capture::QUERY),
              testing::ElementsAre(&set.captures(1), &set.captures(2), &set.captures(3)));
  EXPECT_EQ(CapturesOf(set).size(), 4U);
}

}  // namespace
}  // namespace graspdb::files
