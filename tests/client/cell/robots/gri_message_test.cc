#include "client/cell/robots/gri/gri_message.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <string>

#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename Bytes>
std::string Hex(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 15U];
  }
  return out;
}

// Byte by byte as the documentation lays them out.
TEST(GriMessageTest, ARequestIsLaidOutAsDocumented) {
  GriRequest request;
  request.pose_format = 24;
  request.action = static_cast<std::uint8_t>(GriAction::kTriggerJobSync);
  request.job_id = 0x0102;
  request.pose = {{1, -1, 0x01020304}, {5, 6, 7, -2}};
  request.data = {9, 10, 11, std::numeric_limits<std::int32_t>::min()};
  EXPECT_EQ(Hex(GriBytes(request)),
            "47524900"
            "01"
            "36"
            "18"
            "02"
            "0201"
            "01000000"
            "ffffffff"
            "04030201"
            "05000000"
            "06000000"
            "07000000"
            "feffffff"
            "09000000"
            "0a000000"
            "0b000000"
            "00000080");
}

TEST(GriMessageTest, AResponseIsLaidOutAsDocumented) {
  GriResponse response;
  response.pose_format = 4;
  response.action = 5;
  response.job_id = 7;
  response.code = GriCode::kHecInsufficientDetection;
  response.pose = {{1, 2, 3}, {4, 5, 6, 7}};
  response.data = {0, 1, 2, 3, 4, 5, 6, 7, 8, -9};
  EXPECT_EQ(Hex(GriBytes(response)),
            "47524900"
            "01"
            "50"
            "04"
            "05"
            "0700"
            "eeff"
            "01000000"
            "02000000"
            "03000000"
            "04000000"
            "05000000"
            "06000000"
            "07000000"
            "00000000"
            "01000000"
            "02000000"
            "03000000"
            "04000000"
            "05000000"
            "06000000"
            "07000000"
            "08000000"
            "f7ffffff");
}

TEST(GriMessageTest, ArbitraryBytesSurviveARoundTrip) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    std::array<std::uint8_t, kGriRequestBytes> bytes = {'G', 'R', 'I', 0};
    for (std::size_t at = 4; at < bytes.size(); ++at) {
      bytes[at] = static_cast<std::uint8_t>(random());
    }
    const auto request = ParseGriRequest(bytes);
    ASSERT_THAT(request, IsOk());
    EXPECT_EQ(GriBytes(*request), bytes);
  }
}

TEST(GriMessageTest, AResponseSurvivesARoundTrip) {
  GriResponse response;
  response.code = GriCode::kJobStillRunning;
  response.pose.position = {-1, 2, -3};
  response.data[9] = -4;
  const auto back = ParseGriResponse(GriBytes(response));
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(GriBytes(*back), GriBytes(response));
}

TEST(GriMessageTest, MissingMagicIsRejected) {
  auto bytes = GriBytes(GriRequest());
  for (std::size_t at = 0; at < 4; ++at) {
    auto wrong = bytes;
    wrong[at] ^= 1U;
    EXPECT_THAT(ParseGriRequest(wrong), StatusIs(absl::StatusCode::kInvalidArgument));
  }
}

TEST(GriMessageTest, ResponsesOfOtherVersionsOrLengthsAreRejected) {
  const auto good = GriBytes(GriResponse());
  for (std::size_t at = 0; at < 6; ++at) {
    auto wrong = good;
    wrong[at] ^= 2U;
    EXPECT_THAT(ParseGriResponse(wrong), StatusIs(absl::StatusCode::kInvalidArgument)) << at;
  }
}

TEST(GriMessageTest, EveryHeaderErrorHasItsCode) {
  GriRequest good;
  good.action = 1;
  EXPECT_EQ(CheckGriRequest(good), GriCode::kNoError);
  GriRequest request = good;
  request.version = 2;
  EXPECT_EQ(CheckGriRequest(request), GriCode::kUnknownProtocolVersion);
  request = good;
  request.length = 53;
  EXPECT_EQ(CheckGriRequest(request), GriCode::kInvalidRequestLength);
  for (const int format : {0, 52, 255}) {
    request = good;
    request.pose_format = static_cast<std::uint8_t>(format);
    EXPECT_EQ(CheckGriRequest(request), GriCode::kInvalidRequest);
  }
  for (const int action : {0, 10, 255}) {
    request = good;
    request.action = static_cast<std::uint8_t>(action);
    EXPECT_EQ(CheckGriRequest(request), GriCode::kInvalidAction);
  }
}

TEST(GriPoseTest, PositionsAreMillionthsOfAMillimetre) {
  Pose pose = Pose::Identity();
  pose.translation() << 0.1234567, -2.147483, 0;
  const auto sent = ToGriPose(pose, kQuaternionXyzw);
  ASSERT_THAT(sent, IsOk());
  EXPECT_THAT(sent->position, ElementsAre(123456700, -2147483000, 0));
  EXPECT_THAT(sent->rotation, ElementsAre(0, 0, 0, 1000000));
}

TEST(GriPoseTest, OutOfRangeNumbersAreErrors) {
  for (const double x : {2.1475, -2.1475, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    Pose pose = Pose::Identity();
    pose.translation().y() = x;
    EXPECT_THAT(ToGriPose(pose, 4), StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("2147.48")))
        << x;
  }
}

TEST(GriPoseTest, APoseSurvivesARoundTripInEveryFormat) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int format = 1; format <= kLastPoseFormat; ++format) {
    for (int i = 0; i < 50; ++i) {
      Pose pose = Pose::Identity();
      pose.translation() << 0.3 * normal(random), 0.3 * normal(random), 0.3 * normal(random);
      const Eigen::Vector4d q(normal(random), normal(random), normal(random), normal(random));
      pose.linear() = Eigen::Quaterniond(q).normalized().toRotationMatrix();
      const auto sent = ToGriPose(pose, format);
      ASSERT_THAT(sent, IsOk());
      const auto back = FromGriPose(*sent, format);
      ASSERT_THAT(back, IsOk());
      EXPECT_LT((back->translation() - pose.translation()).norm(), 1e-9);
      EXPECT_LT((back->linear() - pose.linear()).norm(), 5e-6) << "format " << format;
    }
  }
}

}  // namespace
}  // namespace graspdb::client
