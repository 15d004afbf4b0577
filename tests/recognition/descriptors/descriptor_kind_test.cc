// Names, sizes and masses of the three descriptors, and their distance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/scenes/descriptor_parts.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Bins;
using ::graspdb::testing::Mass;
using ::graspdb::testing::Part;
using ::graspdb::testing::Random;
using ::graspdb::testing::WavySurface;

constexpr DescriptorKind kKinds[] = {DescriptorKind::kVfh263, DescriptorKind::kMvfh300,
                                     DescriptorKind::kVfh308, DescriptorKind::kGsh288};

Descriptor DescribeWaves(DescriptorKind kind, std::size_t count) {
  Random random(5);
  const auto descriptor = Describe(WavySurface(random, count), {0.2, -0.1, 0.6}, kind);
  EXPECT_TRUE(descriptor.ok()) << descriptor.status();
  return descriptor.value_or(Descriptor(static_cast<std::size_t>(DescriptorSize(kind))));
}

TEST(DescriptorKindTest, SizesAreThoseOfTheirNames) {
  EXPECT_EQ(DescriptorSize(DescriptorKind::kVfh263), 263);
  EXPECT_EQ(DescriptorSize(DescriptorKind::kMvfh300), 300);
  EXPECT_EQ(DescriptorSize(DescriptorKind::kVfh308), 308);
  EXPECT_EQ(DescribeWaves(DescriptorKind::kVfh263, 100).size(), 263U);
  EXPECT_EQ(DescribeWaves(DescriptorKind::kMvfh300, 100).size(), 300U);
  EXPECT_EQ(DescribeWaves(DescriptorKind::kVfh308, 100).size(), 308U);
  EXPECT_EQ(DescriptorSize(DescriptorKind::kGsh288), 288);
  EXPECT_EQ(DescribeWaves(DescriptorKind::kGsh288, 100).size(), 288U);
}

TEST(DescriptorKindTest, NamesLeadBackToTheirKind) {
  EXPECT_EQ(DescriptorName(DescriptorKind::kVfh263), "vfh263");
  EXPECT_EQ(DescriptorName(DescriptorKind::kMvfh300), "mvfh300");
  EXPECT_EQ(DescriptorName(DescriptorKind::kVfh308), "vfh308");
  EXPECT_EQ(DescriptorName(DescriptorKind::kGsh288), "gsh288");
  for (const DescriptorKind kind : kKinds) {
    EXPECT_EQ(DescriptorFromName(DescriptorName(kind)), kind);
  }
  EXPECT_EQ(DescriptorFromName("MVFH300"), std::nullopt);
  EXPECT_EQ(DescriptorFromName(""), std::nullopt);
}

TEST(DescriptorKindTest, EveryPartHasTheSameMassWhateverTheNumberOfPoints) {
  for (const std::size_t count : {10U, 317U, 4000U}) {
    const Descriptor vfh = DescribeWaves(DescriptorKind::kVfh263, count);
    for (const Part& part : {testing::kAlpha, testing::kPhi, testing::kTheta, testing::kBeta}) {
      EXPECT_NEAR(Mass(Bins(vfh, part)), 1.0 / 4, 1e-5) << part.name << " of " << count;
    }
    const Descriptor mvfh = DescribeWaves(DescriptorKind::kMvfh300, count);
    for (const Part& part : {testing::kAlpha, testing::kPhi, testing::kTheta, testing::kViewAlpha,
                             testing::kViewPhi, testing::kViewTheta}) {
      EXPECT_NEAR(Mass(Bins(mvfh, part)), 1.0 / 6, 1e-5) << part.name << " of " << count;
    }
    EXPECT_NEAR(Mass(vfh), 1, 1e-5);
    EXPECT_NEAR(Mass(mvfh), 1, 1e-5);
  }
}

TEST(DescriptorKindTest, Vfh308HasAHundredAPartAndNoDistancePart) {
  const Descriptor vfh = DescribeWaves(DescriptorKind::kVfh308, 2000);
  for (const std::size_t begin : {0U, 45U, 90U}) {
    EXPECT_NEAR(Mass(Bins(vfh, {"shape", begin, 45, -1, 1})), 100, 0.1);
  }
  EXPECT_EQ(Mass(Bins(vfh, {"distance", 135, 45, 0, 1})), 0);
  EXPECT_NEAR(Mass(Bins(vfh, {"viewpoint", 180, 128, -1, 1})), 100, 0.01);
}

TEST(FingerprintTest, DiffersWithEveryParameter) {
  const DescriptorParameters plain;
  EXPECT_EQ(plain.Fingerprint(), DescriptorParameters().Fingerprint());
  DescriptorParameters kind;
  kind.kind = DescriptorKind::kVfh263;
  DescriptorParameters voxel;
  voxel.voxel_size_m = 0.0031;
  DescriptorParameters radius;
  radius.normal_radius_m = 0.0101;
  for (const DescriptorParameters& other : {kind, voxel, radius}) {
    EXPECT_NE(plain.Fingerprint(), other.Fingerprint());
  }
}

}  // namespace
}  // namespace graspdb::recognition
