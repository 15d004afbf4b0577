#include "server/base/lru_cache.h"

#include <gmock/gmock.h>

namespace graspdb::server {
namespace {

class LruCacheTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kBudget = 1000;

  void Put(const std::string& key, std::size_t bytes) {
    cache_.Put(key, std::make_shared<const int>(1), bytes);
  }
  bool Has(const std::string& key) { return cache_.Get(key) != nullptr; }

  LruCache<int> cache_{kBudget};
};

TEST_F(LruCacheTest, OversizedValueIsNotCachedAndEvictsNothing) {
  for (const char* key : {"a", "b", "c", "d"}) Put(key, 200);
  for (const std::size_t bytes : {kBudget / 2 + 1, kBudget, kBudget + 1, 10 * kBudget}) {
    Put("huge", bytes);
    EXPECT_FALSE(Has("huge"));
  }
  for (const char* key : {"a", "b", "c", "d"}) EXPECT_TRUE(Has(key)) << key;
  EXPECT_EQ(cache_.use().rejected, 4);
  EXPECT_LE(cache_.use().bytes, kBudget);
}

TEST_F(LruCacheTest, ValueOfHalfTheBudgetIsCached) {
  Put("k", kBudget / 2 - 2);  // the key counts twice
  EXPECT_TRUE(Has("k"));
  EXPECT_EQ(cache_.use().rejected, 0);
  EXPECT_EQ(cache_.use().bytes, kBudget / 2);
}

}  // namespace
}  // namespace graspdb::server
