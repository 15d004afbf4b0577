#include "client/cli/base/cache_text.h"

#include <gmock/gmock.h>

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;

v1::CacheStatus Cache(int hits, int misses, int mib) {
  v1::CacheStatus out;
  out.set_hit_count(hits);
  out.set_miss_count(misses);
  out.set_byte_count(std::int64_t{mib} << 20);
  out.set_byte_budget(std::int64_t{192} << 20);
  return out;
}

TEST(CacheTextTest, ReportsTheHitRateAndTheMemory) {
  EXPECT_EQ(CacheText(Cache(973, 27, 168)), "97.3 % of 1000 found, 168 of 192 MiB");
  EXPECT_EQ(CacheText(Cache(0, 0, 0)), "0 of 192 MiB, no requests yet");
}

TEST(CacheTextTest, BytesHaveTheUnitThatSuitsThem) {
  EXPECT_EQ(BytesText(0), "0 B");
  EXPECT_EQ(BytesText(1023), "1023 B");
  EXPECT_EQ(BytesText(36 << 10), "36.0 KiB");
  EXPECT_EQ(BytesText(std::int64_t{63} << 20), "63.0 MiB");
  EXPECT_EQ(BytesText((std::int64_t{3} << 30) / 2), "1.5 GiB");
  EXPECT_EQ(BytesText(std::int64_t{5000} << 40), "5000.0 TiB");
}

TEST(CacheTextTest, BetweenCountsTheRequestsOfARun) {
  const v1::CacheStatus run = Between(Cache(900, 100, 50), Cache(990, 110, 60));
  EXPECT_EQ(CacheText(run), "90.0 % of 100 found, 60 of 192 MiB");
}

TEST(CacheTextTest, AdviceIsGivenOnlyForAFullCacheWithManyMisses) {
  EXPECT_THAT(CacheAdvice(Cache(90, 10, 190)), HasSubstr("--memory-mib"));
  EXPECT_EQ(CacheAdvice(Cache(90, 10, 100)), "");
  EXPECT_EQ(CacheAdvice(Cache(97, 3, 190)), "");
  EXPECT_EQ(CacheAdvice(Cache(0, 0, 190)), "");
}

}  // namespace
}  // namespace graspdb::client
