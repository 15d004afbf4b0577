// Thresholds: the proposals from the views, and the effect of a stable pose's own one.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

class ThresholdsTest : public ServerTest {
 protected:
  // All messages of the stream.
  std::vector<v1::ProposeThresholdsResponse> Propose(const std::string& object,
                                                     grpc::Status* status) {
    v1::ProposeThresholdsRequest request;
    request.set_object(object);
    grpc::ClientContext context;
    const auto reader = Recognition(channel_).ProposeThresholds(&context, request);
    std::vector<v1::ProposeThresholdsResponse> out;
    for (v1::ProposeThresholdsResponse message; reader->Read(&message);) out.push_back(message);
    *status = reader->Finish();
    return out;
  }

  void SetMinScore(const std::string& part, double min_score) {
    v1::UpdateStablePoseRequest request;
    request.mutable_stable_pose()->set_name(FlatPoseOf(part));
    request.mutable_stable_pose()->set_min_score(min_score);
    request.mutable_update_mask()->add_paths("min_score");
    ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  }
};

TEST_F(ThresholdsTest, LastMessageHasTheProposalsAndEarlierOnesTheProgress) {
  Teach("flange", 6);
  Teach("wedge", 6);
  grpc::Status status;
  const auto messages = Propose("", &status);
  ASSERT_THAT(status, IsGrpcOk());
  ASSERT_THAT(messages, SizeIs(13));
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(messages[static_cast<std::size_t>(i)].done_view_count(), i);
    EXPECT_EQ(messages[static_cast<std::size_t>(i)].view_count(), 12);
  }
  const v1::ProposeThresholdsResponse& last = messages.back();
  EXPECT_GT(last.catalog_revision(), 0);
  ASSERT_EQ(last.proposals_size(), 2);
  for (const v1::ThresholdProposal& proposal : last.proposals()) {
    EXPECT_EQ(proposal.asked_view_count(), 6);
    EXPECT_GT(proposal.right_view_count(), 0) << proposal.stable_pose();
    if (!proposal.has_min_score()) continue;
    EXPECT_GE(proposal.min_score(), 0.1);
    EXPECT_LT(proposal.min_score(), 0.5);
  }
}

TEST_F(ThresholdsTest, AnObjectThatIsNotThereIsNotFound) {
  grpc::Status status;
  EXPECT_THAT(Propose("objects/missing", &status), SizeIs(0));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("objects/missing"));
}

TEST_F(ThresholdsTest, OwnThresholdAppliesUnlessTheRequestOverridesIt) {
  Teach("flange", 12);
  v1::RecognizeRequest request = RequestOf(Photograph("flange", {0.02, 0.01, 40}, 7));
  EXPECT_EQ(Answer(request).status(), v1::OK);
  SetMinScore("flange", 1);
  EXPECT_EQ(Answer(request).status(), v1::UNKNOWN_OBJECT);
  Restart();
  EXPECT_EQ(Answer(request).status(), v1::UNKNOWN_OBJECT);
  request.mutable_pipeline()->set_min_score(0.5);
  EXPECT_EQ(Answer(request).status(), v1::OK);
}

}  // namespace
}  // namespace graspdb::testing
