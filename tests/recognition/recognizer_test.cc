// Views and poses recognised in scans.
#include "recognition/recognizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/recognition/scenes/counting_clouds.h"
#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::CountingClouds;
using ::graspdb::testing::IsOk;
using ::graspdb::testing::LargestCornerError;
using ::graspdb::testing::Solid;
using ::graspdb::testing::StatusIs;
using ::graspdb::testing::TaughtShapes;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RecognizerTest : public ::testing::Test {
 protected:
  absl::StatusOr<Recognition> Run(const std::vector<Solid>& parts) {
    return Recognize(TaughtShapes::See(parts), taught_.snapshot(), taught_, parameters_,
                     [] { return false; });
  }

  // The only detection.
  Detection MustDetect(const std::vector<Solid>& parts) {
    const auto found = Run(parts);
    EXPECT_THAT(found, IsOk());
    if (!found.ok() || found->detections.size() != 1) {
      ADD_FAILURE() << "expected exactly one detection";
      return {};
    }
    return found->detections.front();
  }

  TaughtShapes taught_;
  RecognitionParameters parameters_;
};

// Clouds of a cache that keeps nothing: every load makes the same model anew.
class Forgetful : public CountingClouds {
 public:
  using CountingClouds::CountingClouds;

  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) override {
    const auto model = CountingClouds::LoadModel(view, stable_pose);
    if (!model.ok()) return model.status();
    return std::make_shared<const SurfaceModel>(**model);
  }
};

TEST_F(RecognizerTest, EveryPartIsFoundWhereItStands) {
  for (const std::string object : {"bracket", "tower", "slab"}) {
    for (const double yaw : {7.0, 127.0, 236.0}) {
      const Solid part = TaughtShapes::Part(object, 0.05, -0.04, yaw);
      const Detection found = MustDetect({part});
      ASSERT_TRUE(found.view) << object << " " << yaw;
      EXPECT_EQ(found.view->object, "objects/" + object) << yaw;
      EXPECT_LT(LargestCornerError(object, found.refined_pose, part.world_solid), 0.004)
          << object << " " << yaw;
      EXPECT_LT(LargestCornerError(object, found.rough_pose, part.world_solid), 0.08)
          << object << " " << yaw;
      EXPECT_GT(found.score, 0.8) << object << " " << yaw;
      EXPECT_LE(found.score, 1) << object << " " << yaw;
    }
  }
}

TEST_F(RecognizerTest, OneViewIsShiftedFromCentroidToCentroid) {
  parameters_.matching.verified_view_count = 1;
  const Detection found = MustDetect({TaughtShapes::Part("bracket", 0, 0, 12)});
  ASSERT_TRUE(found.view);
  const auto cloud = taught_.Load(*found.view);
  ASSERT_THAT(cloud, IsOk());
  const Pose& taught = found.view->world_object;
  EXPECT_EQ(found.rough_pose.linear(), taught.linear());
  const Eigen::Vector3d shift = found.centroid - Centroid((*cloud)->points);
  EXPECT_LT((found.rough_pose.translation() - taught.translation() - shift).norm(), 1e-12);
  EXPECT_TRUE(found.refined_pose.isApprox(found.registration.target_source * taught, 1e-12));
}

TEST_F(RecognizerTest, CandidatesAreTheTenNearestViewsNearestFirst) {
  const Detection found = MustDetect({TaughtShapes::Part("tower", 0, 0, 33)});
  ASSERT_THAT(found.candidates, SizeIs(10));
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    const Candidate& candidate = found.candidates[i];
    if (candidate.verification_score) {
      EXPECT_LE(*candidate.verification_score, 1);
    }
    if (candidate.view == found.view) {
      EXPECT_EQ(candidate.verification_score, found.evidence.score);
    }
    if (i == 0) continue;
    EXPECT_LE(found.candidates[i - 1].descriptor_distance, candidate.descriptor_distance);
  }
}

TEST_F(RecognizerTest, FewerCandidatesAreListedThanVerified) {
  parameters_.matching.candidate_count = 3;
  EXPECT_THAT(MustDetect({TaughtShapes::Part("tower", 0, 0, 33)}).candidates, SizeIs(3));
}

TEST_F(RecognizerTest, OneVerifiedViewUsesTheDescriptorAlone) {
  parameters_.matching.verified_view_count = 1;
  for (const double yaw : {12.0, 130.0, 275.0}) {
    const Detection found = MustDetect({TaughtShapes::Part("bracket", 0, 0, yaw)});
    ASSERT_THAT(found.candidates, SizeIs(10));
    EXPECT_EQ(found.view, found.candidates[0].view);
    EXPECT_TRUE(found.candidates[0].verification_score);
    EXPECT_FALSE(found.candidates[1].verification_score);
  }
}

TEST_F(RecognizerTest, ThePartNearestToTheSensorComesFirst) {
  const auto found = Run(
      {TaughtShapes::Part("tower", -0.06, 0.09, 20), TaughtShapes::Part("slab", 0.06, -0.06, 80)});
  ASSERT_THAT(found, IsOk());
  ASSERT_THAT(found->detections, SizeIs(2));
  ASSERT_TRUE(found->detections[0].view && found->detections[1].view);
  EXPECT_EQ(found->detections[0].view->object, "objects/slab");
  EXPECT_EQ(found->detections[1].view->object, "objects/tower");
  EXPECT_EQ(found->outcome, RecognitionOutcome::kOk);  // the slab alone has no grasp
  EXPECT_EQ(found->revision, 7);
}

TEST_F(RecognizerTest, SameInputGivesTheSameBits) {
  const Solid part = TaughtShapes::Part("bracket", 0.03, 0.02, 31);
  const Detection first = MustDetect({part});
  const Detection again = MustDetect({part});
  EXPECT_EQ(first.view, again.view);
  EXPECT_EQ(first.score, again.score);
  EXPECT_EQ(first.refined_pose.matrix(), again.refined_pose.matrix());
  ASSERT_EQ(first.candidates.size(), again.candidates.size());
  for (std::size_t i = 0; i < first.candidates.size(); ++i) {
    EXPECT_EQ(first.candidates[i].view, again.candidates[i].view);
    EXPECT_EQ(first.candidates[i].descriptor_distance, again.candidates[i].descriptor_distance);
    EXPECT_EQ(first.candidates[i].verification_score, again.candidates[i].verification_score);
  }
}

// A post before it, outside of the region, hides its middle: the camera sees two pieces.
TEST_F(RecognizerTest, PiecesOfOnePartAreOneDetectionWithoutFurtherViews) {
  parameters_.matching.further_view_budget = 0;
  Solid post{Pose::Identity(), {{{-0.01, -0.006, 0}, {0.01, 0.006, 0.25}}}};
  post.world_solid.translation().y() = -0.14;
  for (const std::string object : {"bracket", "slab"}) {
    const Solid part = TaughtShapes::Part(object, 0, 0, 50);
    Scan scan = TaughtShapes::See({part, post});
    scan.region = Box{{-0.5, -0.1, -0.1}, {0.5, 0.5, 0.5}};
    const auto found =
        Recognize(scan, taught_.snapshot(), taught_, parameters_, [] { return false; });
    ASSERT_THAT(found, IsOk());
    ASSERT_THAT(found->detections, SizeIs(1)) << object;
    ASSERT_TRUE(found->detections[0].view) << object;
    EXPECT_EQ(found->detections[0].view->object, "objects/" + object);
    EXPECT_LT(LargestCornerError(object, found->detections[0].refined_pose, part.world_solid),
              0.004)
        << object;
    EXPECT_EQ(found->untried_view_count, 0) << object;
  }
}

// A post before it hides a part of it: all of the scan lies on the model, but not all of the model
// on the scan.
TEST_F(RecognizerTest, RegistrationHasTheShareOfTheModelThatTheScanShows) {
  Solid post{Pose::Identity(), {{{-0.012, -0.006, 0}, {0.012, 0.006, 0.25}}}};
  post.world_solid.translation().y() = -0.14;
  Scan scan = TaughtShapes::See({TaughtShapes::Part("slab", 0, 0, 50), post});
  scan.region = Box{{-0.5, -0.1, -0.1}, {0.5, 0.5, 0.5}};
  const auto found =
      Recognize(scan, taught_.snapshot(), taught_, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  ASSERT_THAT(found->detections, SizeIs(1));
  const Registration& hidden = found->detections[0].registration;
  EXPECT_GT(found->detections[0].evidence.scan_explained, 0.9);
  EXPECT_LT(hidden.inlier_fraction, 0.85);
  EXPECT_GT(hidden.inlier_fraction, 0.3);
  const Registration whole = MustDetect({TaughtShapes::Part("slab", 0, 0, 50)}).registration;
  EXPECT_GT(whole.inlier_fraction, 0.95);
  EXPECT_TRUE(whole.converged);
  EXPECT_GT(whole.iterations, 10);
}

// A post hides the middle of the bracket: its farther piece moves its centroid behind the tower's.
TEST_F(RecognizerTest, APartOfSeveralPiecesIsSortedByAllOfIt) {
  Solid post{Pose::Identity(), {{{-0.006, -0.006, 0}, {0.006, 0.006, 0.25}}}};
  post.world_solid.translation() = Eigen::Vector3d(-0.06, -0.14, 0);
  Scan scan = TaughtShapes::See({TaughtShapes::Part("bracket", -0.08, 0, 110), post,
                                 TaughtShapes::Part("tower", 0.1, 0, 10)});
  scan.region = Box{{-0.5, -0.1, -0.1}, {0.5, 0.5, 0.5}};
  const auto found =
      Recognize(scan, taught_.snapshot(), taught_, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  ASSERT_THAT(found->detections, SizeIs(2));
  ASSERT_TRUE(found->detections[0].view && found->detections[1].view);
  EXPECT_EQ(found->detections[0].view->object, "objects/tower");
  const Eigen::Vector3d sensor = TaughtShapes::WorldSensor().translation();
  EXPECT_LT((found->detections[0].centroid - sensor).norm(),
            (found->detections[1].centroid - sensor).norm());
}

TEST_F(RecognizerTest, EmptyCatalogueGivesUnknownObjects) {
  const CatalogueSnapshot empty{3, DescriptorIndex(300), nullptr};
  const auto found = Recognize(TaughtShapes::See({TaughtShapes::Part("slab", 0, 0, 0)}), empty,
                               taught_, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  ASSERT_THAT(found->detections, SizeIs(1));
  EXPECT_EQ(found->outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(found->detections[0].outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(found->detections[0].view, nullptr);
  EXPECT_THAT(found->detections[0].candidates, IsEmpty());
  EXPECT_GT(found->detections[0].point_count, 50U);
}

TEST_F(RecognizerTest, ScoreBelowTheMinimumIsUnknownWithoutAView) {
  parameters_.matching.min_score = 0.9999;
  const Detection found = MustDetect({TaughtShapes::Part("bracket", 0.03, 0, 9)});
  EXPECT_EQ(found.outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(found.view, nullptr);
  EXPECT_THAT(found.grasps, IsEmpty());
  EXPECT_THAT(found.candidates, SizeIs(10));
}

TEST_F(RecognizerTest, ObjectThatWasNotTaughtIsUnknown) {
  Solid plate;
  plate.boxes = {{{-0.11, -0.11, 0}, {0.11, 0.11, 0.015}}};
  EXPECT_EQ(MustDetect({plate}).outcome, RecognitionOutcome::kUnknownObject);
}

TEST_F(RecognizerTest, AlignmentWithTooFewInliersIsRejected) {
  parameters_.matching.min_inlier_fraction = 1.01;
  const Detection found = MustDetect({TaughtShapes::Part("bracket", 0, 0, 10)});
  EXPECT_EQ(found.outcome, RecognitionOutcome::kIcpRejected);
  EXPECT_THAT(found.grasps, IsEmpty());
}

TEST_F(RecognizerTest, ScansWithoutASegmentGiveTheReason) {
  EXPECT_EQ(Run({})->outcome, RecognitionOutcome::kNoCluster);
  Scan nothing;
  nothing.points.assign(100, Eigen::Vector3f::Zero());
  const auto found =
      Recognize(nothing, taught_.snapshot(), taught_, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  EXPECT_EQ(found->outcome, RecognitionOutcome::kEmptyRegion);
  EXPECT_THAT(found->detections, IsEmpty());
}

class NoClouds : public ViewClouds {
  absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView&) override {
    return absl::DataLossError("the cloud is damaged");
  }
  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(const TaughtView&,
                                                                const TaughtStablePose&) override {
    return absl::DataLossError("the cloud is damaged");
  }
};

TEST_F(RecognizerTest, ErrorOfTheCloudsIsReturned) {
  NoClouds damaged;
  const Scan scan = TaughtShapes::See({TaughtShapes::Part("slab", 0, 0, 0)});
  EXPECT_THAT(Recognize(scan, taught_.snapshot(), damaged, parameters_, [] { return false; }),
              StatusIs(absl::StatusCode::kDataLoss));
}

TEST_F(RecognizerTest, CancellationIsPolledBeforeEveryAlignment) {
  const Scan scan = TaughtShapes::See({TaughtShapes::Part("slab", 0, 0, 0)});
  for (const int limit : {1, 3, 8, 12}) {
    int polls = 0;
    EXPECT_THAT(
        Recognize(scan, taught_.snapshot(), taught_, parameters_, [&] { return ++polls >= limit; }),
        StatusIs(absl::StatusCode::kCancelled))
        << limit;
    EXPECT_EQ(polls, limit);
  }
}

TEST_F(RecognizerTest, StagesCoverTheWholePipeline) {
  const auto found = Run({TaughtShapes::Part("slab", 0, 0, 0)});
  ASSERT_THAT(found, IsOk());
  std::vector<std::string> stages;
  for (const StageReport& report : found->stages) stages.push_back(report.stage);
  EXPECT_THAT(stages, ::testing::ElementsAre("region", "plane", "outliers", "voxels", "clusters",
                                             "normals", "descriptor", "match", "register", "frame",
                                             "verify", "propose"));
}

// As when two requests load a model first, or memory is short.
TEST_F(RecognizerTest, AModelThatIsMadeAnewGivesTheSameAnswer) {
  Forgetful forgetful(taught_);
  for (const double yaw : {7.0, 10.0, 127.0}) {
    const Scan scan = TaughtShapes::See({TaughtShapes::Part("bracket", 0.05, -0.04, yaw)});
    const auto known = Recognize(scan, taught_.snapshot(), taught_, {}, [] { return false; });
    const auto anew = Recognize(scan, taught_.snapshot(), forgetful, {}, [] { return false; });
    ASSERT_THAT(known, IsOk());
    ASSERT_THAT(anew, IsOk());
    const Detection& a = known->detections.at(0);
    const Detection& b = anew->detections.at(0);
    EXPECT_EQ(a.equivalent_poses.size(), b.equivalent_poses.size());
    ASSERT_EQ(a.candidates.size(), b.candidates.size());
    for (std::size_t i = 0; i < a.candidates.size(); ++i) {
      EXPECT_EQ(a.candidates[i].verification_score, b.candidates[i].verification_score);
    }
  }
}

}  // namespace
}  // namespace graspdb::recognition
