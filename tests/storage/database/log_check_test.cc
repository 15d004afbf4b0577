#include "storage/database/log_check.h"

#include <cstdint>
#include <string>

#include "gtest/gtest.h"
#include "storage/base/crc32c.h"

namespace graspdb::storage {
namespace {

constexpr std::size_t kBlock = 32768;
enum Type : char { kFull = 1, kFirst = 2, kMiddle = 3, kLast = 4 };

std::string Record(Type type, const std::string& payload) {
  const std::string typed = std::string(1, type) + payload;
  const std::uint32_t crc = Crc32c(typed);
  const std::uint32_t masked = ((crc >> 15) | (crc << 17)) + 0xa282ead8U;
  std::string record;
  for (int shift = 0; shift < 32; shift += 8) record += static_cast<char>((masked >> shift) & 0xff);
  record += static_cast<char>(payload.size() & 0xff);
  record += static_cast<char>(payload.size() >> 8);
  return record + typed;
}

std::string Write() { return Record(kFull, std::string(100, 'w')); }
// A batch without entries.
std::string Mark() { return Record(kFull, std::string(12, '\0')); }

TEST(LogCheckTest, AnIntactLogIsComplete) {
  const LogVerdict verdict = InspectLog(Write() + Write() + Mark());
  EXPECT_TRUE(verdict.complete);
  EXPECT_FALSE(verdict.damaged);
  EXPECT_TRUE(verdict.has_writes);
}

TEST(LogCheckTest, EmptyLogAndMarkHaveNoWrite) {
  for (const std::string& log : {std::string(), Mark(), std::string(5000, '\0')}) {
    const LogVerdict verdict = InspectLog(log);
    EXPECT_TRUE(verdict.complete);
    EXPECT_FALSE(verdict.damaged);
    EXPECT_FALSE(verdict.has_writes);
  }
}

TEST(LogCheckTest, TruncatedTailIsACrash) {
  const std::string log = Write() + Write();
  for (std::size_t size = Write().size() + 1; size < log.size(); ++size) {
    const LogVerdict verdict = InspectLog(log.substr(0, size));
    EXPECT_FALSE(verdict.damaged) << size;
    EXPECT_FALSE(verdict.complete) << size;
    EXPECT_TRUE(verdict.has_writes) << size;
  }
}

TEST(LogCheckTest, AnyFlippedByteBeforeAnIntactWriteIsDamage) {
  const std::string log = Write() + Write();
  for (std::size_t i = 0; i < Write().size(); ++i) {
    std::string flipped = log;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x55);
    EXPECT_TRUE(InspectLog(flipped).damaged) << i;
  }
}

TEST(LogCheckTest, ZerosBeforeAnIntactWriteAreDamage) {
  EXPECT_TRUE(InspectLog(Write() + std::string(300, '\0') + Write()).damaged);
  EXPECT_TRUE(InspectLog(Write() + std::string(2 * kBlock, '\0') + Write()).damaged);
}

// One write over three blocks, of which the second lost a page.
TEST(LogCheckTest, AHoleInTheLastWriteIsACrash) {
  const std::string first = Record(kFirst, std::string(kBlock - 7, 'a'));
  const std::string middle = Record(kMiddle, std::string(kBlock - 7, 'b'));
  const std::string last = Record(kLast, "c");
  EXPECT_TRUE(InspectLog(first + middle + last).complete);
  EXPECT_TRUE(InspectLog(first + middle + last).has_writes);
  EXPECT_FALSE(InspectLog(first + middle).complete);
  std::string holed = first + middle + last;
  holed.replace(kBlock + 4096, 4096, 4096, '\0');
  EXPECT_FALSE(InspectLog(holed).damaged);
  EXPECT_FALSE(InspectLog(holed).complete);
  EXPECT_TRUE(InspectLog(holed + Write()).damaged) << "but not when a write follows";
}

TEST(LogCheckTest, AWriteInsideAWriteIsDamage) {
  EXPECT_TRUE(InspectLog(Record(kFirst, "a") + Write()).damaged);
}

TEST(LogCheckTest, TheEndOfABlockTooShortForARecordIsSkipped) {
  const std::string almost = Record(kFull, std::string(kBlock - 7 - 3, 'x'));
  const LogVerdict verdict = InspectLog(almost + std::string(3, '\0') + Write());
  EXPECT_TRUE(verdict.complete);
  EXPECT_FALSE(verdict.damaged);
}

}  // namespace
}  // namespace graspdb::storage
