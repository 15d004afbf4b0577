#include <gmock/gmock.h>

#include "client/cli/objects/commands.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ThresholdText, ReportsTheScoresBehindTheThreshold) {
  v1::ThresholdProposal proposal;
  proposal.set_stable_pose("objects/cup/stablePoses/up");
  proposal.set_asked_view_count(8);
  proposal.set_right_view_count(7);
  proposal.set_right_score(0.61);
  proposal.set_min_score(0.36);
  EXPECT_THAT(ThresholdText(proposal),
              AllOf(HasSubstr("objects/cup/stablePoses/up: 0.36"), HasSubstr("7 of 8 views named"),
                    HasSubstr("most with 0.61"), Not(HasSubstr("taken for it"))));
  proposal.clear_min_score();
  EXPECT_THAT(ThresholdText(proposal), HasSubstr("objects/cup/stablePoses/up: as all; "));
  proposal.set_wrong_score(0.11);
  proposal.set_wrong_view("objects/mug/stablePoses/up/views/v1");
  EXPECT_THAT(ThresholdText(proposal),
              HasSubstr("objects/mug/stablePoses/up/views/v1 taken for it with 0.11"));
}

}  // namespace
}  // namespace graspdb::client
