#include "client/teaching/turntable/look_alikes_text.h"

#include <gmock/gmock.h>

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

v1::FindLookAlikesResponse Symmetry(int declared, int found, bool nearly) {
  v1::FindLookAlikesResponse out;
  v1::StablePoseSymmetry* s = out.add_symmetries();
  s->set_stable_pose("objects/cup/stablePoses/up");
  s->set_declared_order(declared);
  s->set_found_order(found);
  s->set_nearly(nearly);
  s->mutable_gap()->set_mean_m(0.0007);
  return out;
}

TEST(LookAlikesText, ASymmetryThatIsNotDeclaredIsProposed) {
  EXPECT_THAT(LookAlikesText(Symmetry(1, 0, false), true),
              ElementsAre(AllOf(HasSubstr("objects/cup"), HasSubstr("any turn, 0.7 mm"),
                                HasSubstr("declare symmetryOrder 0"))));
}

TEST(LookAlikesText, ADeclaredSymmetryIsNotReported) {
  EXPECT_THAT(LookAlikesText(Symmetry(4, 4, false), true), IsEmpty());
}

TEST(LookAlikesText, ADeclaredSymmetryThatTheViewsContradictIsReported) {
  EXPECT_THAT(LookAlikesText(Symmetry(2, 1, false), true),
              ElementsAre(AllOf(HasSubstr("half a turn"), HasSubstr("views differ"))));
}

TEST(LookAlikesText, NearSymmetriesAreOmittedUnlessRequested) {
  EXPECT_THAT(LookAlikesText(Symmetry(1, 3, true), true),
              ElementsAre(HasSubstr("nearly the same")));
  EXPECT_THAT(LookAlikesText(Symmetry(1, 3, true), false), IsEmpty());
}

TEST(LookAlikesText, PairsAreReportedWithTheConsequence) {
  v1::FindLookAlikesResponse found;
  v1::LookAlikePair* pair = found.add_pairs();
  pair->set_stable_pose("objects/a/stablePoses/p");
  pair->set_other("objects/b/stablePoses/p");
  EXPECT_THAT(LookAlikesText(found, false),
              ElementsAre(AllOf(HasSubstr("objects/a"), HasSubstr("objects/b"),
                                HasSubstr("will be AMBIGUOUS"))));
}

}  // namespace
}  // namespace graspdb::client
