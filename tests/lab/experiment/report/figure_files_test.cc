#include "lab/experiment/report/figure_files.h"

#include <gmock/gmock.h>

#include "lab/experiment/report/markup.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

TEST(FigureFiles, EveryPlotIsAFileWithItsStyle) {
  const std::string markup = "<p>words</p>" + SvgFrame(10, 20, "Turn & shift", "<g></g>") +
                             "<p>more</p>" + SvgFrame(5, 5, "Time", "");
  const std::vector<FigureFile> files = FigureFiles("hidden-20", markup);
  ASSERT_THAT(files, SizeIs(2));
  EXPECT_EQ(files[0].name, "hidden-20-turn-amp-shift.svg");
  EXPECT_THAT(files[0].svg, AllOf(HasSubstr("<style>"), HasSubstr(".f0 { fill: #0072b2; }")));
  EXPECT_THAT(files[0].svg, Not(HasSubstr("var("))) << "only browsers know it";
  EXPECT_THAT(files[0].svg, HasSubstr("<g></g></svg>"));
  EXPECT_EQ(files[1].name, "hidden-20-time.svg");
}

TEST(FigureFiles, PlotsOfOneTitleAreNumbered) {
  const std::string plot = SvgFrame(1, 1, "Same", "");
  const std::vector<FigureFile> files = FigureFiles("case", plot + plot);
  ASSERT_THAT(files, SizeIs(2));
  EXPECT_EQ(files[0].name, "case-same.svg");
  EXPECT_EQ(files[1].name, "case-same-2.svg");
}

TEST(FigureFiles, WithoutPlotsThereAreNone) {
  EXPECT_THAT(FigureFiles("case", "<p></p>"), SizeIs(0));
}

}  // namespace
}  // namespace graspdb::client
