#include "client/cell/calibration/target/pose_certainty.h"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;
using recognition::Points;
using recognition::Pose;

// A plate of 60 x 60 mm in the plane z = 0 that faces up.
recognition::OrientedCloud Plate() {
  recognition::OrientedCloud cloud;
  for (int i = -10; i <= 10; ++i) {
    for (int k = -10; k <= 10; ++k) {
      cloud.points.emplace_back(0.003F * static_cast<float>(i), 0.003F * static_cast<float>(k),
                                0.0F);
      cloud.normals.emplace_back(Vector3f::UnitZ());
    }
  }
  return cloud;
}

// Three of them, at right angles to each other.
recognition::OrientedCloud Corner() {
  const recognition::OrientedCloud plate = Plate();
  recognition::OrientedCloud cloud;
  for (int turn = 0; turn < 3; ++turn) {
    for (const Vector3f& p : plate.points) {
      const Vector3f moved = p + Vector3f(0, 0, 0.03F);
      cloud.points.emplace_back(moved[turn], moved[(turn + 1) % 3], moved[(turn + 2) % 3]);
      cloud.normals.emplace_back(Vector3f::Unit((5 - turn) % 3));
    }
  }
  return cloud;
}

class CovarianceOfTest : public ::testing::Test {
 protected:
  CovarianceOfTest() { sensor_plate_.translation() = Eigen::Vector3d(0.05, -0.02, 0.7); }

  // Of the fully visible plate.
  Matrix6d PlateCovariance(bool on_table) const {
    return CovarianceOf(model_, SensorPoints(plate_), sensor_plate_, on_table);
  }
  Points SensorPoints(const recognition::OrientedCloud& cloud) const {
    Points out;
    for (const Vector3f& p : cloud.points) out.push_back(sensor_plate_.cast<float>() * p);
    return out;
  }

  static double Deviation(const Matrix6d& covariance, int i) { return std::sqrt(covariance(i, i)); }

  recognition::OrientedCloud plate_ = Plate();
  recognition::SurfaceModel model_{plate_, 1};
  Pose sensor_plate_ = Pose::Identity();
};

TEST_F(CovarianceOfTest, AFlatObjectIsWeaklyConstrainedAlongItsPlane) {
  const Matrix6d covariance = PlateCovariance(/*on_table=*/false);
  EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-9));
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0], 0);
  // The constraint of its edges: 1.5 mm along it, 1.5 degrees about its normal.
  EXPECT_NEAR(Deviation(covariance, 3), 0.0015, 0.0001);
  EXPECT_NEAR(Deviation(covariance, 4), 0.0015, 0.0001);
  EXPECT_NEAR(Deviation(covariance, 2), 1.5 * recognition::kRadiansPerDegree,
              0.1 * recognition::kRadiansPerDegree);
  EXPECT_LT(Deviation(covariance, 5), 0.0005);
  EXPECT_LT(Deviation(covariance, 0), 0.75 * Deviation(covariance, 2));
  EXPECT_LT(Deviation(covariance, 1), 0.75 * Deviation(covariance, 2));
}

// Detections of the stepped block with visible faces in all directions have errors of a tenth of a
// degree, those of a single face a degree along it: the former must have a much larger weight.
TEST_F(CovarianceOfTest, FacesInAllDirectionsConstrainThePose) {
  const recognition::OrientedCloud corner = Corner();
  const Matrix6d corner_covariance =
      CovarianceOf({corner, 1}, SensorPoints(corner), sensor_plate_, /*on_table=*/false);
  const Matrix6d plate_covariance = PlateCovariance(/*on_table=*/false);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(Deviation(corner_covariance, i), 0.4 * recognition::kRadiansPerDegree) << i;
  for (int i = 3; i < 6; ++i) EXPECT_LT(Deviation(corner_covariance, i), 0.0004) << i;
  EXPECT_LT(Deviation(corner_covariance, 2), 0.3 * Deviation(plate_covariance, 2));
}

TEST_F(CovarianceOfTest, ATableConstrainsTiltAndHeight) {
  const Matrix6d off_table = PlateCovariance(/*on_table=*/false);
  const Matrix6d on_table = PlateCovariance(/*on_table=*/true);
  for (const int i : {0, 1, 5}) EXPECT_LT(Deviation(on_table, i), Deviation(off_table, i)) << i;
  for (const int i : {2, 3, 4})
    EXPECT_NEAR(Deviation(on_table, i), Deviation(off_table, i), 1e-6) << i;
  EXPECT_LT(Deviation(on_table, 5), 0.0004);
}

TEST_F(CovarianceOfTest, PointsOffTheObjectAreIgnored) {
  Points beside = SensorPoints(plate_);
  for (const Vector3f& p : SensorPoints(plate_)) beside.push_back(p + Vector3f(0, 0, 0.02F));
  beside.emplace_back(Vector3f::Constant(std::nanf("")));
  EXPECT_TRUE(
      CovarianceOf(model_, beside, sensor_plate_, false).isApprox(PlateCovariance(false), 1e-12));
  const Matrix6d unseen = CovarianceOf(model_, {}, sensor_plate_, false);
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(Deviation(unseen, i), 0.0015, 0.0001) << i;
}

TEST(UsualCovariance, IsAFifthOfADegreeAndHalfAMillimetre) {
  const Matrix6d usual = UsualCovariance();
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(std::sqrt(usual(i, i)), 0.2 * recognition::kRadiansPerDegree, 1e-12);
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(std::sqrt(usual(i, i)), 0.0005, 1e-12);
  EXPECT_TRUE(usual.isDiagonal());
}

}  // namespace
}  // namespace graspdb::client
