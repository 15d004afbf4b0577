// graspdb describe, which needs no server.
#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <numeric>
#include <sstream>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/end_to_end/fixtures/written_clouds.h"

namespace graspdb::end_to_end {
namespace {

class DescribeTest : public ProgramsTest {
 protected:
  static std::vector<double> Numbers(const std::string& out) {
    std::istringstream stream(out);
    std::vector<double> numbers;
    for (double number = 0; stream >> number;) numbers.push_back(number);
    EXPECT_TRUE(stream.eof()) << "no number: " << out;
    return numbers;
  }

  static double Sum(const std::vector<double>& numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0);
  }

  const std::string cloud_ = folder_.Write("cloud.pcd", AsciiPcd(CurvedPatch(900))).string();
};

TEST_F(DescribeTest, DescriptorsHaveTheirSizeAndMass) {
  for (const auto& [name, size, mass] :
       {std::tuple("mvfh300", 300U, 1.0), std::tuple("vfh263", 263U, 1.0),
        std::tuple("gsh288", 288U, 1.0), std::tuple("vfh308", 308U, 400.0)}) {
    const std::vector<double> bins =
        Numbers(Succeed({"describe", cloud_, "--descriptor", name}).out);
    EXPECT_EQ(bins.size(), size);
    EXPECT_NEAR(Sum(bins), mass, 1e-3 * mass) << name;
  }
}

TEST_F(DescribeTest, Mvfh300IsTheDefaultAndTheOutputIsTheSameEachTime) {
  const std::string out = Succeed({"describe", cloud_}).out;
  EXPECT_EQ(Numbers(out).size(), 300U);
  EXPECT_EQ(Succeed({"describe", cloud_, "--descriptor", "mvfh300"}).out, out);
}

TEST_F(DescribeTest, DependsOnTheViewpoint) {
  const std::string out = Succeed({"describe", cloud_}).out;
  EXPECT_EQ(Succeed({"describe", cloud_, "--viewpoint", "0,0,0"}).out, out);
  EXPECT_NE(Succeed({"describe", cloud_, "--viewpoint", "0.5,-0.2,0"}).out, out);
}

TEST_F(DescribeTest, JsonHasTheSameBins) {
  const std::vector<double> bins = Numbers(Succeed({"describe", cloud_}).out);
  google::protobuf::Struct document;
  const Finished outcome = Succeed({"describe", cloud_, "--json"});
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &document).ok());
  EXPECT_EQ(document.fields().at("path").string_value(), cloud_);
  EXPECT_EQ(document.fields().at("descriptor").string_value(), "mvfh300");
  EXPECT_GE(document.fields().at("pointCount").number_value(), 100);
  const auto& values = document.fields().at("bins").list_value().values();
  ASSERT_EQ(static_cast<std::size_t>(values.size()), bins.size());
  for (int i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(values[i].number_value(), bins[static_cast<std::size_t>(i)], 1e-8);
  }
}

TEST_F(DescribeTest, UsesNormalsOfTheFile) {
  const std::string with_normals =
      folder_.Write("normals.pcd", AsciiPcdWithNormals(CurvedPatch(900), {0, 0, -1})).string();
  EXPECT_NE(Succeed({"describe", with_normals}).out, Succeed({"describe", cloud_}).out);
}

TEST_F(DescribeTest, RequiresTenPoints) {
  const std::string ten = folder_.Write("ten.pcd", AsciiPcd(CurvedPatch(10))).string();
  Succeed({"describe", ten});
  const std::string nine = folder_.Write("nine.pcd", AsciiPcd(CurvedPatch(9))).string();
  const Finished outcome = Graspdb({"describe", nine});
  EXPECT_THAT(outcome, EndsWith(1));
  EXPECT_THAT(outcome, PrintsOnly("graspdb", "nine.pcd"));
  EXPECT_EQ(outcome.out, "");
}

}  // namespace
}  // namespace graspdb::end_to_end
