// Drafts and labels: what a request meets.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

constexpr char kWedgeName[] = "objects/wedge";

class ReleaseTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Teach("wedge", 4);
    Teach("flange", 4);
  }

  void SetObject(const std::string& name, v1::ReleaseState release,
                 const std::vector<std::string>& labels = {}) {
    v1::UpdateObjectRequest request;
    request.mutable_object()->set_name(name);
    request.mutable_object()->set_release(release);
    request.mutable_object()->mutable_labels()->Assign(labels.begin(), labels.end());
    request.mutable_update_mask()->add_paths("release");
    request.mutable_update_mask()->add_paths("labels");
    ASSERT_THAT(Call(&Catalog::UpdateObject, request), IsGrpcOk());
  }
  void MakeCell(const std::string& id, const std::vector<std::string>& labels,
                bool include_drafts) {
    v1::CreateCellRequest request;
    request.set_cell_id(id);
    request.mutable_cell()->mutable_labels()->Assign(labels.begin(), labels.end());
    request.mutable_cell()->set_include_drafts(include_drafts);
    ASSERT_THAT(Call(&Cells::CreateCell, request), IsGrpcOk());
  }

  // The response to a frame of the part, without the revision.
  v1::RecognizeResponse See(const std::string& part, const std::string& cell = "") {
    v1::RecognizeRequest request = RequestOf(Photograph(part, {.x = 0.02, .turn_deg = 30}, 5));
    if (!cell.empty()) request.set_cell("cells/" + cell);
    v1::RecognizeResponse response = Answer(request);
    response.clear_catalog_revision();
    return response;
  }
  // The object of the best detection; empty for none.
  static std::string ObjectIn(const v1::RecognizeResponse& response) {
    return response.status() == v1::OK ? response.detections(0).object() : "";
  }
  // Objects of all candidates.
  static std::vector<std::string> CandidatesIn(const v1::RecognizeResponse& response) {
    std::vector<std::string> out;
    for (const auto& detection : response.detections()) {
      for (const auto& candidate : detection.candidates()) {
        out.push_back(candidate.view().substr(0, candidate.view().find("/stablePoses")));
      }
    }
    return out;
  }
};

TEST_F(ReleaseTest, WhatDoesNotSayIsReleased) {
  EXPECT_EQ(ObjectIn(See("wedge")), kWedgeName);
  MakeCell("press", {}, false);
  EXPECT_EQ(ObjectIn(See("wedge", "press")), kWedgeName);
}

TEST_F(ReleaseTest, ADraftIsRecognisedInATestCellOnly) {
  MakeCell("press", {}, false);
  MakeCell("test", {}, true);
  const std::string before = See("wedge").SerializeAsString();
  SetObject(kWedgeName, v1::RELEASE_STATE_DRAFT);
  for (const char* cell : {"", "press"}) {
    const v1::RecognizeResponse response = See("wedge", cell);
    EXPECT_EQ(ObjectIn(response), "") << cell;
    EXPECT_THAT(CandidatesIn(response), ::testing::Each("objects/flange")) << cell;
  }
  EXPECT_EQ(ObjectIn(See("wedge", "test")), kWedgeName);
  Restart();
  EXPECT_EQ(ObjectIn(See("wedge")), "");
  SetObject(kWedgeName, v1::RELEASE_STATE_RELEASED);
  EXPECT_EQ(See("wedge").SerializeAsString(), before);
}

TEST_F(ReleaseTest, ADraftHasNoInfluenceOnOtherObjects) {
  const std::string with_both = See("flange").SerializeAsString();
  SetObject(kWedgeName, v1::RELEASE_STATE_DRAFT);
  const std::string draft = See("flange").SerializeAsString();
  v1::DeleteObjectRequest remove;
  remove.set_name(kWedgeName);
  remove.set_force(true);
  ASSERT_THAT(Call(&Catalog::DeleteObject, remove), IsGrpcOk());
  EXPECT_EQ(See("flange").SerializeAsString(), draft) << "the same bytes as without it";
  EXPECT_NE(draft, with_both) << "else this test shows nothing";
}

TEST_F(ReleaseTest, ADraftOfAStablePoseIsHiddenAlone) {
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(FlatPoseOf("wedge"));
  request.mutable_stable_pose()->set_release(v1::RELEASE_STATE_DRAFT);
  request.mutable_update_mask()->add_paths("release");
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  EXPECT_EQ(ObjectIn(See("wedge")), "");
  MakeCell("test", {}, true);
  EXPECT_EQ(ObjectIn(See("wedge", "test")), kWedgeName);
  request.mutable_stable_pose()->set_release(v1::RELEASE_STATE_RELEASED);
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  EXPECT_EQ(ObjectIn(See("wedge")), kWedgeName);
}

TEST_F(ReleaseTest, ACellMeetsObjectsWithItsLabels) {
  SetObject(kWedgeName, v1::RELEASE_STATE_RELEASED, {"line-1", "small"});
  MakeCell("one", {"line-1"}, false);
  MakeCell("two", {"line-2", "line-3"}, false);
  MakeCell("all", {}, false);
  EXPECT_EQ(ObjectIn(See("wedge", "one")), kWedgeName);
  EXPECT_EQ(ObjectIn(See("flange", "one")), "");
  EXPECT_EQ(See("wedge", "two").status(), v1::UNKNOWN_OBJECT) << "as with an empty catalogue";
  EXPECT_EQ(ObjectIn(See("flange", "all")), "objects/flange");
  SetObject("objects/flange", v1::RELEASE_STATE_RELEASED, {"line-3"});
  EXPECT_EQ(ObjectIn(See("flange", "two")), "objects/flange");
  SetObject(kWedgeName, v1::RELEASE_STATE_DRAFT, {"line-1"});
  EXPECT_EQ(ObjectIn(See("wedge", "one")), "");
}

TEST_F(ReleaseTest, AnUpdateThatDoesNotSayKeepsTheState) {
  SetObject(kWedgeName, v1::RELEASE_STATE_DRAFT);
  v1::UpdateObjectRequest request;
  request.mutable_object()->set_name(kWedgeName);
  request.mutable_object()->set_display_name("A client of before");
  v1::Object updated;
  ASSERT_THAT(Call(&Catalog::UpdateObject, request, &updated), IsGrpcOk());
  EXPECT_EQ(updated.release(), v1::RELEASE_STATE_DRAFT);
}

TEST_F(ReleaseTest, WrongStatesAndLabelsAreRejected) {
  v1::UpdateObjectRequest object;
  object.mutable_object()->set_name(kWedgeName);
  object.mutable_object()->set_release(static_cast<v1::ReleaseState>(7));
  EXPECT_THAT(Call(&Catalog::UpdateObject, object).error_message(),
              ::testing::HasSubstr("object.release"));
  v1::CreateCellRequest cell;
  cell.set_cell_id("press");
  cell.mutable_cell()->add_labels("line 1");
  EXPECT_THAT(Call(&Cells::CreateCell, cell).error_message(),
              ::testing::HasSubstr("cell.labels[0]"));
  cell.mutable_cell()->clear_labels();
  for (int i = 0; i < 33; ++i) cell.mutable_cell()->add_labels("l" + std::to_string(i));
  EXPECT_THAT(Call(&Cells::CreateCell, cell).error_message(), ::testing::HasSubstr("at most 32"));
}

}  // namespace
}  // namespace graspdb::testing
