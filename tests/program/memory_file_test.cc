#include "program/tls/memory_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using testing::IsOk;

time_t TimeOf(const MemoryFile& file) {
  struct stat status {};
  EXPECT_EQ(stat(file.path().c_str(), &status), 0);
  return status.st_mtime;
}

TEST(MemoryFile, IsEmptyAndOf1970AtFirst) {
  const MemoryFile file;
  EXPECT_EQ(files::BytesOf(file.path()), "");
  EXPECT_EQ(TimeOf(file), 0);
}

TEST(MemoryFile, TheSamePathHasEachTextWithAnotherTime) {
  MemoryFile file;
  const std::string path = file.path();
  EXPECT_THAT(file.Replace("a long text"), IsOk());
  EXPECT_EQ(files::BytesOf(path), "a long text");
  const time_t first = TimeOf(file);
  EXPECT_NE(first, 0);
  std::ifstream reader(path);
  EXPECT_THAT(file.Replace("short"), IsOk());
  EXPECT_EQ(file.path(), path);
  EXPECT_EQ(files::BytesOf(path), "short");
  EXPECT_NE(TimeOf(file), first);
  std::string line;
  std::getline(reader, line);
  EXPECT_EQ(line, "a long text");  // for the one that had it open
}

}  // namespace
}  // namespace graspdb
