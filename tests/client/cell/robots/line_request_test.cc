#include "client/cell/robots/line/line_request.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>

#include "client/cell/robots/pose_format.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr auto kWrong = absl::StatusCode::kInvalidArgument;

TEST(LineRequestTest, ParsesAJobAndItsPose) {
  const auto request = ParseLineRequest("run 7 100 -20.5 +3e2 0 0 90", 4);
  ASSERT_THAT(request, IsOk());
  EXPECT_EQ(request->command, LineCommand::kRun);
  EXPECT_EQ(request->job, 7);
  EXPECT_EQ(request->format, std::nullopt);
  ASSERT_TRUE(request->base_flange);
  EXPECT_TRUE(request->base_flange->translation().isApprox(Eigen::Vector3d(0.1, -0.0205, 0.3)));
  const Eigen::AngleAxisd quarter(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(request->base_flange->linear().isApprox(quarter.toRotationMatrix()));
}

TEST(LineRequestTest, AFormatBeforeACommandAppliesToItsPose) {
  const auto request = ParseLineRequest("FORMAT abb RUN 7 1 2 3 1 0 0 0", 4);
  ASSERT_THAT(request, IsOk());
  EXPECT_EQ(request->format, kQuaternionWxyz);
  EXPECT_TRUE(request->base_flange->linear().isIdentity());
}

TEST(LineRequestTest, AFormatAloneIsACommand) {
  const auto request = ParseLineRequest("\tformat  kuka ", std::nullopt);
  ASSERT_THAT(request, IsOk());
  EXPECT_EQ(request->command, LineCommand::kFormat);
  EXPECT_EQ(request->format, 24);
}

TEST(LineRequestTest, VendorsAndCodesAreFormats) {
  EXPECT_THAT(PoseFormatNamed("Staubli"), IsOk());
  EXPECT_EQ(*PoseFormatNamed("STAUBLI"), 4);
  EXPECT_EQ(*PoseFormatNamed("fanuc"), 26);
  EXPECT_EQ(*PoseFormatNamed("KAWASAKI"), 48);
  EXPECT_EQ(*PoseFormatNamed("ur"), 3);
  EXPECT_EQ(*PoseFormatNamed("51"), 51);
  for (const char* none : {"0", "52", "-4", "4.0", "ACME", ""}) {
    EXPECT_THAT(PoseFormatNamed(none), StatusIs(kWrong, HasSubstr("1 to 51"))) << none;
  }
}

TEST(LineRequestTest, UnknownCommandsAreReported) {
  EXPECT_THAT(ParseLineRequest("PICK 7", 4),
              StatusIs(absl::StatusCode::kUnimplemented, HasSubstr("HELP")));
  EXPECT_THAT(ParseLineRequest("", 4), StatusIs(kWrong, HasSubstr("empty")));
  EXPECT_THAT(ParseLineRequest(" \t ", 4), StatusIs(kWrong, HasSubstr("empty")));
  EXPECT_THAT(ParseLineRequest("FORMAT", 4), StatusIs(kWrong));
}

TEST(LineRequestTest, AJobIsANumberInRange) {
  EXPECT_EQ(ParseLineRequest("NEXT 0", 4)->job, 0);
  EXPECT_EQ(ParseLineRequest("NEXT 65535", 4)->job, 65535);
  for (const char* none : {"65536", "-1", "1.5", "seven", "99999999999999999999"}) {
    EXPECT_THAT(ParseLineRequest(std::string("NEXT ") + none, 4),
                StatusIs(kWrong, HasSubstr("65535")))
        << none;
  }
  EXPECT_THAT(ParseLineRequest("NEXT", 4), StatusIs(kWrong, HasSubstr("needs")));
  EXPECT_THAT(ParseLineRequest("NEXT 7 8", 4), StatusIs(kWrong, HasSubstr("nothing")));
  EXPECT_THAT(ParseLineRequest("PICKED 7", 4), StatusIs(kWrong, HasSubstr("nothing")));
}

TEST(LineRequestTest, APoseMustBeCompleteAndHaveAFormat) {
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0 0 0 0", 4), IsOk());
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0 0", 4), StatusIs(kWrong, HasSubstr("not 5")));
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0 0 0 0 0", 4), StatusIs(kWrong, HasSubstr("not 8")));
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0 0 0 1", 4), StatusIs(kWrong, HasSubstr("fourth")));
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 1 0 0", 1), IsOk());
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0.5 0 0 0", 1), StatusIs(kWrong, HasSubstr("length")));
  EXPECT_THAT(ParseLineRequest("RUN 7 1 2 3 0 0 0", std::nullopt),
              StatusIs(kWrong, HasSubstr("FORMAT STAUBLI")));
}

TEST(LineRequestTest, OutOfRangeNumbersAreErrors) {
  const auto with = [](const std::string& number) {
    return ParseLineRequest("START 7 " + number + " 0 0 0 0 0", 4);
  };
  EXPECT_THAT(with("100000"), IsOk());
  EXPECT_THAT(with("-100000"), IsOk());
  for (const char* none : {"100000.1", "-1e9", "1e400", "nan", "inf", "-Infinity", "0x10", "1,5",
                           "1.2.3", "--1", "e", "."}) {
    EXPECT_THAT(with(none), StatusIs(kWrong)) << none;
  }
}

TEST(LineRequestTest, AnglesBeyondATurnAreErrors) {
  EXPECT_THAT(ParseLineRequest("RUN 7 0 0 0 360 -360 0", 4), IsOk());
  EXPECT_THAT(ParseLineRequest("RUN 7 0 0 0 361 0 0", 4), StatusIs(kWrong, HasSubstr("unit")));
  EXPECT_THAT(ParseLineRequest("RUN 7 0 0 0 180 0 0", 5), StatusIs(kWrong, HasSubstr("unit")));
  EXPECT_THAT(ParseLineRequest("RUN 7 0 0 0 3.14159 0 0", 5), IsOk());
  EXPECT_THAT(ParseLineRequest("RUN 7 0 0 0 0 0 7", 3), StatusIs(kWrong, HasSubstr("unit")));
}

}  // namespace
}  // namespace graspdb::client
