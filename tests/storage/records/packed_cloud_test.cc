#include "storage/records/packed_cloud.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "storage/base/crc32c.h"

namespace graspdb::storage {
namespace {

using Cloud = std::vector<CloudPoint>;

Cloud RandomCloud(std::size_t count, float extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-extent, extent);
  Cloud cloud(count);
  for (CloudPoint& point : cloud) {
    for (float& value : point) value = coordinate(random);
  }
  return cloud;
}

std::string PackOrDie(const Cloud& cloud) {
  auto packed = PackCloud(cloud);
  EXPECT_TRUE(packed.ok()) << packed.status();
  return packed.ok() ? *std::move(packed) : std::string();
}

// The header of a cloud with that number of points before `frame`, checksum and all.
std::string Forge(std::uint32_t count, std::string_view frame) {
  std::string bytes("GPC\x01", 4);
  const auto append = [&bytes](std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xff);
  };
  append(count);
  append(Crc32c(frame, Crc32c(bytes)));
  return bytes + std::string(frame);
}

TEST(Crc32cTest, MatchesThePublishedCheckValueAndChains) {
  EXPECT_EQ(Crc32c("123456789"), 0xe3069283U);
  EXPECT_EQ(Crc32c(""), 0U);
  EXPECT_EQ(Crc32c("6789", Crc32c("12345")), Crc32c("123456789"));
}

TEST(Crc32cTest, ManyBytesAtOnceHaveTheChecksumOfOneByOne) {
  std::string bytes;
  std::uint32_t one_by_one = 0;
  for (int i = 0; i < 100; ++i) {
    bytes += static_cast<char>(i * i);
    one_by_one = Crc32c(bytes.substr(bytes.size() - 1), one_by_one);
    EXPECT_EQ(Crc32c(bytes), one_by_one) << i;
  }
}

TEST(PackedCloudTest, MovesACoordinateByHalfAStepAtMost) {
  for (const float extent : {0.001F, 0.5F, 3.0F, 100.0F}) {
    const Cloud cloud = RandomCloud(2000, extent, 7);
    const auto unpacked = UnpackCloud(PackOrDie(cloud));
    ASSERT_TRUE(unpacked.ok()) << unpacked.status();
    ASSERT_EQ(unpacked->size(), cloud.size());
    // At 100 m a float has a resolution of 4 micrometres only.
    const double tolerance = kCloudStep / 2 + 1e-7 * static_cast<double>(extent);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR((*unpacked)[i][axis], cloud[i][axis], tolerance) << i;
      }
    }
  }
}

TEST(PackedCloudTest, RoundsToTheNearestStepAndHalvesAwayFromZero) {
  Cloud cloud = RandomCloud(5000, 100, 9);
  for (int steps = -3000; steps < 3000; ++steps) {
    const auto halfway = static_cast<float>((steps + 0.5) * kCloudStep);
    cloud.push_back({halfway, std::nextafter(halfway, 1.0F), std::nextafter(halfway, -1.0F)});
  }
  const auto unpacked = UnpackCloud(PackOrDie(cloud));
  ASSERT_TRUE(unpacked.ok()) << unpacked.status();
  ASSERT_EQ(unpacked->size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const long steps = std::lround(static_cast<double>(cloud[i][axis]) / kCloudStep);
      ASSERT_EQ((*unpacked)[i][axis], static_cast<float>(static_cast<double>(steps) * kCloudStep));
    }
  }
}

TEST(PackedCloudTest, AnUnpackedCloudPacksToTheSameBytes) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const std::size_t count = std::size_t{37} * seed;
    const float extent = seed % 3 == 0 ? 100.0F : 1.0F;
    const std::string packed = PackOrDie(RandomCloud(count, extent, seed));
    const auto unpacked = UnpackCloud(packed);
    ASSERT_TRUE(unpacked.ok()) << unpacked.status();
    EXPECT_EQ(PackOrDie(*unpacked), packed);
    EXPECT_EQ(*UnpackCloud(PackOrDie(*unpacked)), *unpacked);
  }
}

TEST(PackedCloudTest, WhatAThreadPackedBeforeDoesNotChangeTheBytes) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Cloud cloud = RandomCloud(1 + std::size_t{900} * seed, 0.01F, seed);
    std::string alone;
    std::thread([&] { alone = PackOrDie(cloud); }).join();
    for (const std::size_t count : {0U, 2000U, 300'000U, 7U}) {
      PackOrDie(RandomCloud(count, seed % 2 == 0 ? 0.01F : 1.0F, seed + 1));
      EXPECT_EQ(PackOrDie(cloud), alone);
      EXPECT_EQ(PackOrDie(cloud), alone);
    }
  }
}

TEST(PackedCloudTest, PackingGivesTheUnpackedPoints) {
  for (const std::size_t count : {0U, 1U, 255U, 256U, 257U, 3000U}) {
    for (const float extent : {0.001F, 1.0F, 100.0F}) {
      Cloud given = {{1, 2, 3}};
      const auto packed = PackCloud(RandomCloud(count, extent, 11), &given);
      ASSERT_TRUE(packed.ok()) << packed.status();
      const auto unpacked = UnpackCloud(*packed);
      ASSERT_TRUE(unpacked.ok()) << unpacked.status();
      EXPECT_EQ(given, *unpacked) << count;
    }
  }
}

TEST(PackedCloudTest, KeepsOrderAndDuplicates) {
  const Cloud cloud = {{1, 2, 3}, {-1, -2, -3}, {1, 2, 3}, {0, 0, 0}, {1, 2, 3}};
  const auto unpacked = UnpackCloud(PackOrDie(cloud));
  ASSERT_TRUE(unpacked.ok());
  EXPECT_EQ(*unpacked, cloud);
}

TEST(PackedCloudTest, EmptyCloudIsValid) {
  const auto unpacked = UnpackCloud(PackOrDie({}));
  ASSERT_TRUE(unpacked.ok()) << unpacked.status();
  EXPECT_TRUE(unpacked->empty());
}

TEST(PackedCloudTest, ASmoothSurfaceTakesAThirdOfItsFloats) {
  Cloud cloud;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const float x = static_cast<float>(column) * 0.003F;
      const float y = static_cast<float>(row) * 0.003F;
      cloud.push_back({x, y, 0.8F + 0.05F * std::sin(20 * x) * std::cos(20 * y)});
    }
  }
  EXPECT_LT(PackOrDie(cloud).size(), cloud.size() * sizeof(CloudPoint) / 3);
}

TEST(PackedCloudTest, AcceptsTheFarthestCoordinatesAndTheirGreatestDifference) {
  const Cloud cloud = {{-100, 100, -100}, {100, -100, 100}, {-100, 100, -100}};
  const auto unpacked = UnpackCloud(PackOrDie(cloud));
  ASSERT_TRUE(unpacked.ok()) << unpacked.status();
  EXPECT_EQ(*unpacked, cloud);
}

TEST(PackedCloudTest, RejectsInvalidCoordinates) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float bad : {std::nanf(""), kInfinity, -kInfinity, 100.1F, -100.1F, 1e30F}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Cloud cloud(10, {0.1F, 0.2F, 0.3F});
      cloud[9][axis] = bad;
      EXPECT_EQ(PackCloud(cloud).status().code(), absl::StatusCode::kInvalidArgument) << bad;
    }
  }
}

TEST(PackedCloudTest, EveryFlippedBitIsDetected) {
  const std::string packed = PackOrDie(RandomCloud(60, 1.0F, 3));
  for (std::size_t i = 0; i < packed.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = packed;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      ASSERT_EQ(UnpackCloud(damaged).status().code(), absl::StatusCode::kDataLoss)
          << "byte " << i << " bit " << bit;
    }
  }
}

TEST(PackedCloudTest, EveryTruncationAndExtensionIsDetected) {
  const std::string packed = PackOrDie(RandomCloud(60, 1.0F, 3));
  for (std::size_t size = 0; size < packed.size(); ++size) {
    ASSERT_EQ(UnpackCloud(packed.substr(0, size)).status().code(), absl::StatusCode::kDataLoss);
  }
  EXPECT_FALSE(UnpackCloud(packed + '\0').ok());
  EXPECT_FALSE(UnpackCloud(packed + packed).ok());
}

TEST(PackedCloudTest, MaliciousBytesWithAValidChecksumAreDetected) {
  const std::string honest = PackOrDie(RandomCloud(60, 1.0F, 3)).substr(12);
  ASSERT_TRUE(UnpackCloud(Forge(60, honest)).ok()) << "the forgery itself must be right";
  for (const std::uint32_t count : {0U, 59U, 61U, 180U, 10'000'001U, 0xffffffffU}) {
    EXPECT_EQ(UnpackCloud(Forge(count, honest)).status().code(), absl::StatusCode::kDataLoss);
  }
  EXPECT_FALSE(UnpackCloud(Forge(1, "")).ok());
  // A frame header that gives a size of 2^60 bytes.
  const std::string boast("\x28\xb5\x2f\xfd\xe4\x00\x00\x00\x00\x00\x00\x00\x10", 13);
  EXPECT_FALSE(UnpackCloud(Forge(10'000'000, boast)).ok());
}

TEST(PackedCloudTest, RandomFramesWithAValidChecksumAreDetected) {
  std::mt19937 random(11);
  const std::string honest = PackOrDie(RandomCloud(60, 1.0F, 3)).substr(12);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string frame = honest;
    const std::size_t at = random() % frame.size();
    frame[at] = static_cast<char>(random() & 0xff);
    const auto unpacked = UnpackCloud(Forge(60, frame));
    // Some bits of a zstd header are unused; then the points are the same.
    if (unpacked.ok()) {
      EXPECT_EQ(*unpacked, *UnpackCloud(Forge(60, honest)));
    }
  }
}

}  // namespace
}  // namespace graspdb::storage
