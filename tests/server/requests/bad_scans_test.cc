// Invalid scans in Recognize and UploadViews: each gets its code, its field and a
// sentence, and changes nothing.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

struct BadScan {
  std::string name;
  std::function<void(v1::RecognizeRequest&)> spoil;  // a good request with a cloud
  std::string field;
  std::string words;
};

void PrintTo(const BadScan& bad, std::ostream* out) { *out << bad.name; }

std::string BadScanName(const ::testing::TestParamInfo<BadScan>& info) { return info.param.name; }

recognition::Points Grid(std::size_t count, float spacing, float depth) {
  recognition::Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / 20;
    const std::size_t column = i % 20;
    points.emplace_back(static_cast<float>(column) * spacing, static_cast<float>(row) * spacing,
                        depth);
  }
  return points;
}

class SmallServerTest : public ServerTest {
 protected:
  void SetUp() override {
    options_.max_points = 100'000;
    options_.max_message_mib = 4;
    ServerTest::SetUp();
    Declare("wedge");
  }
};

class BadScanTest : public SmallServerTest, public ::testing::WithParamInterface<BadScan> {};
class BadFrameTest : public BadScanTest {};

TEST_P(BadScanTest, IsRejectedByRecognize) {
  const std::int64_t revision = Status().catalog_revision();
  v1::RecognizeRequest request = RequestOf(PhotographEmptyTable());
  GetParam().spoil(request);
  ExpectBadField(Call(&Recognition::Recognize, request), GetParam().field, GetParam().words);
  EXPECT_EQ(Status().catalog_revision(), revision);
}

TEST_P(BadFrameTest, IsRejectedByRecognizeAndUploadViews) {
  const std::int64_t revision = Status().catalog_revision();
  v1::RecognizeRequest request = RequestOf(PhotographEmptyTable());
  GetParam().spoil(request);
  ExpectBadField(Call(&Recognition::Recognize, request), GetParam().field, GetParam().words);
  v1::UploadViewsRequest upload = ViewOf("wedge", 0, "a");
  v1::View& view = *upload.mutable_view();
  view.clear_cloud();
  if (request.has_cloud()) *view.mutable_cloud() = request.cloud();
  if (request.has_depth_image()) *view.mutable_depth_image() = request.depth_image();
  ExpectBadField(Upload(upload), "view." + GetParam().field, GetParam().words);
  EXPECT_EQ(Status().catalog_revision(), revision);
}

using BadScanRequest = v1::RecognizeRequest;

INSTANTIATE_TEST_SUITE_P(
    Layout, BadFrameTest,
    ::testing::Values(
        BadScan{"NoStride", [](BadScanRequest& r) { r.mutable_cloud()->clear_point_stride(); },
                "cloud.point_stride", "1 to 4096"},
        BadScan{"NegativeStride",
                [](BadScanRequest& r) { r.mutable_cloud()->set_point_stride(-12); },
                "cloud.point_stride", "1 to 4096"},
        BadScan{"HugeStride",
                [](BadScanRequest& r) { r.mutable_cloud()->set_point_stride(1 << 30); },
                "cloud.point_stride", "1 to 4096"},
        BadScan{"DataCutOff",
                [](BadScanRequest& r) { r.mutable_cloud()->mutable_data()->pop_back(); },
                "cloud.data", "multiple of the stride"},
        BadScan{"NoData", [](BadScanRequest& r) { r.mutable_cloud()->clear_data(); }, "cloud.data",
                "0 bytes"},
        BadScan{"NoFields", [](BadScanRequest& r) { r.mutable_cloud()->clear_fields(); },
                "cloud.fields", "no \"x\""},
        BadScan{"NoX",
                [](BadScanRequest& r) { r.mutable_cloud()->mutable_fields(0)->set_name("u"); },
                "cloud.fields", "no \"x\""},
        BadScan{"FieldBeyondStride",
                [](BadScanRequest& r) { r.mutable_cloud()->mutable_fields(2)->set_offset(9); },
                "cloud.fields[2].offset", "within the stride of 12"},
        BadScan{"FieldBeforeThePoint",
                [](BadScanRequest& r) { r.mutable_cloud()->mutable_fields(1)->set_offset(-4); },
                "cloud.fields[1].offset", "is -4"},
        BadScan{"DoubleThatDoesNotFit",
                [](BadScanRequest& r) {
                  r.mutable_cloud()->mutable_fields(2)->set_type(
                      v1::PackedElementField::NUMERIC_TYPE_FLOAT64);
                },
                "cloud.fields[2].offset", "within the stride"},
        BadScan{"FieldOfNoType",
                [](BadScanRequest& r) { r.mutable_cloud()->mutable_fields(0)->clear_type(); },
                "cloud.fields[0].type", "FLOAT32"}),
    BadScanName);

INSTANTIATE_TEST_SUITE_P(
    Content, BadFrameTest,
    ::testing::Values(BadScan{"OnlyNan",
                              [](BadScanRequest& r) {
                                *r.mutable_cloud() = PackedCloud(
                                    recognition::Points(100, Eigen::Vector3f::Constant(kNanF)));
                              },
                              "cloud", "no measurement"},
                      BadScan{"OnlyZeros",
                              [](BadScanRequest& r) {
                                *r.mutable_cloud() =
                                    PackedCloud(recognition::Points(100, Eigen::Vector3f::Zero()));
                              },
                              "cloud", "no measurement"},
                      BadScan{"Millimetres",
                              [](BadScanRequest& r) {
                                *r.mutable_cloud() = PackedCloud(Grid(400, 3, 650));
                              },
                              "cloud", "millimetres"},
                      BadScan{"TooManyPoints",
                              [](BadScanRequest& r) {
                                *r.mutable_cloud() = PackedCloud(Grid(100'001, 0.001F, 1));
                              },
                              "cloud", "at most 100000"}),
    BadScanName);

INSTANTIATE_TEST_SUITE_P(
    Settings, BadScanTest,
    ::testing::Values(
        BadScan{"NoScan", [](BadScanRequest& r) { r.clear_scan(); }, "scan", "is missing"},
        BadScan{"ZeroQuaternion",
                [](BadScanRequest& r) { r.mutable_sensor_pose()->clear_orientation(); },
                "sensor_pose.orientation", "unit quaternion"},
        BadScan{"NanQuaternion",
                [](BadScanRequest& r) {
                  r.mutable_sensor_pose()->mutable_orientation()->set_w(static_cast<double>(kNanF));
                },
                "sensor_pose.orientation", "unit quaternion"},
        BadScan{"FarAway",
                [](BadScanRequest& r) { r.mutable_sensor_pose()->mutable_position()->set_y(1e9); },
                "sensor_pose.position", "1000 m"},
        BadScan{"RegionWithoutVolume",
                [](BadScanRequest& r) {
                  *r.mutable_region_of_interest() = BoxMessage({0, 0, 0}, {0, 1, 1});
                },
                "region_of_interest", "is empty"},
        BadScan{"ScoreAboveOne",
                [](BadScanRequest& r) { r.mutable_pipeline()->set_min_score(1.01); },
                "pipeline.min_score", "0 to 1"},
        BadScan{"NanTolerance",
                [](BadScanRequest& r) {
                  r.mutable_pipeline()->set_cluster_tolerance_m(static_cast<double>(kNanF));
                },
                "pipeline.cluster_tolerance_m", "0.003 to 0.2"},
        BadScan{"CellOfAnotherKind", [](BadScanRequest& r) { r.set_cell("objects/wedge"); }, "cell",
                "objects/wedge"}),
    BadScanName);

BadScan DepthImage(const std::string& name, const std::function<void(v1::DepthImage&)>& spoil,
                   const std::string& field, const std::string& words) {
  return {name,
          [=](BadScanRequest& request) {
            *request.mutable_depth_image() = DepthImageOf(PhotographEmptyTable());
            spoil(*request.mutable_depth_image());
          },
          "depth_image." + field, words};
}

INSTANTIATE_TEST_SUITE_P(
    DepthImages, BadFrameTest,
    ::testing::Values(
        DepthImage(
            "DepthWithoutIntrinsics", [](v1::DepthImage& image) { image.clear_intrinsics(); },
            "intrinsics", "width and height"),
        DepthImage(
            "DepthOfAnotherSize",
            [](v1::DepthImage& image) { image.mutable_intrinsics()->set_width(255); }, "data",
            "pixels need"),
        DepthImage(
            "NegativeFocalLength",
            [](v1::DepthImage& image) { image.mutable_intrinsics()->set_fx(-1); }, "intrinsics",
            "positive focal"),
        DepthImage(
            "NanPrincipalPoint",
            [](v1::DepthImage& image) {
              image.mutable_intrinsics()->set_cx(static_cast<double>(kNanF));
            },
            "intrinsics", "finite"),
        DepthImage(
            "HugeImage",
            [](v1::DepthImage& image) {
              image.mutable_intrinsics()->set_width(1 << 30);
              image.mutable_intrinsics()->set_height(1 << 30);
            },
            "intrinsics", "at most 100000"),
        DepthImage(
            "NegativeDepthUnit", [](v1::DepthImage& image) { image.set_depth_unit_m(-0.001); },
            "depth_unit_m", "0 to 0.1"),
        DepthImage(
            "MetresAsDepthUnit", [](v1::DepthImage& image) { image.set_depth_unit_m(1); },
            "depth_unit_m", "0 to 0.1"),
        BadScan{"BlackDepthImage",
                [](BadScanRequest& r) {
                  *r.mutable_depth_image() = DepthImageOf(PhotographEmptyTable());
                  std::string& data = *r.mutable_depth_image()->mutable_data();
                  data.assign(data.size(), '\0');
                },
                "depth_image", "no measurement"}),
    BadScanName);

TEST_F(SmallServerTest, OversizedMessageIsRejected) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = PackedCloud(Grid(500'000, 0.001F, 1));
  const grpc::Status status = Call(&Recognition::Recognize, request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_NE(status.error_message(), "");
  EXPECT_EQ(Status().object_count(), 1);
}

TEST_F(SmallServerTest, TooFewPointsHaveNoCluster) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = PackedCloud(Grid(9, 0.004F, 0.6F));
  request.set_segmented(true);
  EXPECT_EQ(Answer(request).status(), v1::NO_CLUSTER);
}

TEST_F(SmallServerTest, PointsInOnePlaceHaveNoCluster) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() =
      PackedCloud(recognition::Points(5000, Eigen::Vector3f(0.1F, 0.1F, 0.6F)));
  request.set_segmented(true);
  EXPECT_EQ(Answer(request).status(), v1::NO_CLUSTER);
}

TEST_F(SmallServerTest, FewFarPointsAreHarmless) {
  recognition::Points points = Grid(2000, 0.004F, 0.6F);
  for (std::size_t i = 0; i < points.size(); i += 100) points[i].x() = i % 200 == 0 ? 3e38F : 1e9F;
  v1::RecognizeRequest request;
  *request.mutable_cloud() = PackedCloud(points);
  request.set_segmented(true);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.status(), v1::UNKNOWN_OBJECT);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_LT(answer.detections(0).centroid().x(), 0.1);
}

TEST_F(SmallServerTest, AnOutlierInAFullFrameIsLeftOut) {
  v1::RecognizeRequest request = RequestOf(PhotographEmptyTable());
  const float far[3] = {1e30F, -1e30F, 1e9F};
  request.mutable_cloud()->mutable_data()->replace(0, sizeof(far),
                                                   reinterpret_cast<const char*>(far), sizeof(far));
  EXPECT_EQ(Answer(request).status(), v1::NO_CLUSTER);
}

TEST_F(SmallServerTest, WithoutTableAndPoseTheWorldIsTheSensors) {
  recognition::Points points;
  for (int i = 0; i < 3000; ++i) {  // a ball before the sensor
    const double turn = 2.399963 * i;
    const double z = 1 - 2 * (i + 0.5) / 3000;
    const double r = std::sqrt(1 - z * z);
    points.push_back((Eigen::Vector3d(0, 0, 0.8) +
                      0.1 * Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z))
                         .cast<float>());
  }
  v1::RecognizeRequest request;
  *request.mutable_cloud() = PackedCloud(points);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_SENSOR);
  EXPECT_EQ(answer.status(), v1::UNKNOWN_OBJECT);
  // A region is relative to the table.
  request.mutable_region_of_interest()->mutable_max()->set_x(0.2);
  request.mutable_region_of_interest()->mutable_max()->set_y(0.2);
  request.mutable_region_of_interest()->mutable_max()->set_z(0.2);
  ExpectError(Call(&Recognition::Recognize, request), grpc::StatusCode::FAILED_PRECONDITION,
              "plane");
}

}  // namespace
}  // namespace graspdb::testing
