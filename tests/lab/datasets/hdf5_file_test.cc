#include "lab/datasets/hdf5_file.h"

#include <gmock/gmock.h>

#include <limits>
#include <thread>

#include "tests/files/temporary_folder.h"
#include "tests/lab/datasets/hdf5_writer.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Hdf5FileTest : public ::testing::Test {
 protected:
  absl::StatusOr<Eigen::MatrixXd> Read(const std::string& name, int rows, int columns) const {
    return ReadHdf5(path_, name, rows, columns);
  }

  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "numbers.h5";
};

TEST_F(Hdf5FileTest, NumbersOfAnyTypeAreReadRowByRow) {
  const float singles[] = {1, 2, 3, 4, 5, 6};
  const std::int16_t integers[] = {-1, 2, 3, 4, 5, 600};
  Hdf5Writer(path_)
      .Add("doubles", (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished())
      .Add("singles", {2, 3}, H5T_IEEE_F32BE, singles)
      .Add("integers", {2, 3}, H5T_NATIVE_INT16, integers);
  const Eigen::MatrixXd wanted = (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished();
  const auto doubles = Read("doubles", 2, 3);
  ASSERT_THAT(doubles, IsOk());
  EXPECT_EQ(*doubles, wanted);
  const auto read = Read("integers", 2, 3);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ((*read)(0, 0), -1);
  EXPECT_EQ((*read)(1, 2), 600);
  EXPECT_THAT(Read("singles", 2, 3), IsOk());
}

TEST_F(Hdf5FileTest, AxesOfLengthOneMayBeLeftOut) {
  const double values[] = {1, 2, 3, 4, 5};
  Hdf5Writer(path_)
      .Add("vector", {5}, H5T_NATIVE_DOUBLE, values)
      .Add("row", {1, 5}, H5T_NATIVE_DOUBLE, values)
      .Add("number", {}, H5T_NATIVE_DOUBLE, values)
      .Add("one", {1}, H5T_NATIVE_DOUBLE, values);
  for (const char* name : {"vector", "row"}) {
    const auto read = Read(name, 5, 1);
    ASSERT_THAT(read, IsOk()) << name;
    EXPECT_EQ((*read)(4, 0), 5) << name;
  }
  for (const char* name : {"number", "one"}) {
    const auto read = Read(name, 1, 1);
    ASSERT_THAT(read, IsOk()) << name;
    EXPECT_EQ((*read)(0, 0), 1) << name;
  }
}

TEST_F(Hdf5FileTest, WhatIsNotThereIsNamed) {
  EXPECT_THAT(Read("pose", 4, 4),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("numbers.h5 does not exist")));
  Hdf5Writer(path_).Add("other", Eigen::Matrix4d::Identity());
  EXPECT_THAT(Read("pose", 4, 4), StatusIs(absl::StatusCode::kNotFound,
                                           AllOf(HasSubstr("numbers.h5: pose is not there"))));
}

TEST_F(Hdf5FileTest, AnotherShapeIsRefusedAndTold) {
  Hdf5Writer(path_)
      .Add("small", Eigen::Matrix3d::Identity())
      .Add("flat", Eigen::MatrixXd::Zero(16, 1))
      .Add("turned", Eigen::MatrixXd::Zero(3, 4));
  for (const char* name : {"small", "flat"}) {
    EXPECT_THAT(Read(name, 4, 4),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("it must be 4 x 4")));
  }
  EXPECT_THAT(Read("turned", 4, 3),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("has the shape (3, 4)")));
}

TEST_F(Hdf5FileTest, WhatIsNoFiniteNumberIsRefused) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(2, 3) = std::numeric_limits<double>::quiet_NaN();
  const char letter = 'x';
  Hdf5Writer(path_).Add("broken", matrix).Add("text", {1}, H5T_C_S1, &letter);
  EXPECT_THAT(Read("broken", 4, 4),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_THAT(Read("text", 1, 1),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("does not hold numbers")));
}

TEST_F(Hdf5FileTest, AFileThatIsNoHdf5OrCutShortIsRefusedInSilence) {
  ::testing::internal::CaptureStderr();
  folder_.Write("numbers.h5", "no HDF5\n");
  EXPECT_THAT(Read("pose", 4, 4),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("is no HDF5 file")));
  Hdf5Writer(path_).Add("pose", Eigen::Matrix4d::Identity());
  const std::string whole = BytesOf(path_);
  folder_.Write("numbers.h5", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Read("pose", 4, 4),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("cut short or damaged")));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(Hdf5FileTest, SeveralThreadsReadAtOnce) {
  Hdf5Writer(path_).Add("pose", 7 * Eigen::Matrix4d::Identity());
  std::vector<std::thread> threads;
  std::vector<double> read(4);
  threads.reserve(read.size());
  for (double& value : read) {
    threads.emplace_back([&, this] {
      for (int i = 0; i < 50; ++i) value += Read("pose", 4, 4).value()(3, 3);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(read, ::testing::Each(7 * 50));
}

}  // namespace
}  // namespace graspdb::client
