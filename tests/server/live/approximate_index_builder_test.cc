// --index flann.
#include "server/live/approximate_index_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "storage/database/approximate_file.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr int kViews = 24;

class ApproximateIndexBuilderTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    for (const char* part : {"wedge", "l-bracket", "post-plate"}) Teach(part, kViews);
    for (const char* part : {"wedge", "l-bracket", "post-plate"}) {
      requests_.push_back(RequestOf(Photograph(part, {.turn_deg = 8}, 3)));
      exact_.push_back(BytesOf(requests_.back()));
    }
    EXPECT_FALSE(Status().has_approximate_index());
    options_.index = "flann";
    Restart();
  }

  // Of the response, without its timings.
  std::string BytesOf(const v1::RecognizeRequest& request) {
    v1::RecognizeResponse response = Answer(request);
    EXPECT_EQ(response.status(), v1::OK);
    response.clear_stages();
    return response.SerializeAsString();
  }

  void ExpectExactAnswers() {
    for (std::size_t i = 0; i < requests_.size(); ++i) {
      EXPECT_EQ(BytesOf(requests_[i]), exact_[i]) << i;
    }
  }

  std::string Path() const {
    return options_.database + "/" + std::string(storage::kApproximateFile);
  }
  std::string File() const {
    std::ifstream file(Path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::vector<v1::RecognizeRequest> requests_;
  std::vector<std::string> exact_;
};

TEST_F(ApproximateIndexBuilderTest, ResponsesEqualExactSearchAndSurviveARestart) {
  EXPECT_EQ(Status().approximate_index().view_count(), 3 * kViews);
  EXPECT_EQ(Status().approximate_index().recall_at_10(), 1);
  ExpectExactAnswers();
  const std::string file = File();
  ASSERT_FALSE(file.empty());
  Restart();
  EXPECT_EQ(File(), file);
  EXPECT_EQ(Status().approximate_index().view_count(), 3 * kViews);
  ExpectExactAnswers();
}

TEST_F(ApproximateIndexBuilderTest, DamagedFileIsRebuilt) {
  server_.reset();
  std::string file = File();
  file[file.size() / 2] = static_cast<char>(file[file.size() / 2] ^ 1);
  std::ofstream(Path(), std::ios::binary) << file;
  Start();
  EXPECT_NE(File(), file);
  EXPECT_EQ(Status().approximate_index().view_count(), 3 * kViews);
  ExpectExactAnswers();
}

TEST_F(ApproximateIndexBuilderTest, ChangedViewsAreSearchedExactlyUntilTheRebuild) {
  ASSERT_THAT(Upload(ViewOf("wedge", 3, "newer")).error_message(), "");
  EXPECT_EQ(Status().approximate_index().newer_view_count(), 1);
  const std::string file = File();
  Restart();  // one of 73 views: the file stays
  EXPECT_EQ(File(), file);
  EXPECT_EQ(Status().approximate_index().newer_view_count(), 1);
  for (int i = 0; i < 16; ++i) {
    ASSERT_THAT(Upload(ViewOf("wedge", 4 + i, "newer-" + std::to_string(i))).error_message(), "");
  }
  Restart();
  EXPECT_NE(File(), file);
  EXPECT_EQ(Status().approximate_index().view_count(), 3 * kViews + 17);
  EXPECT_EQ(Status().approximate_index().newer_view_count(), 0);
}

}  // namespace
}  // namespace graspdb::testing
