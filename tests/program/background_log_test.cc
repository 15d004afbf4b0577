#include "program/log/background_log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

namespace graspdb {
namespace {

using ::testing::ExitedWithCode;

// More than wait in memory and in a pipe.
constexpr int kManyLines = 20'000;

using PipeEnds = std::array<int, 2>;

PipeEnds PipeInPlaceOfStandardError() {
  PipeEnds ends{};
  if (pipe(ends.data()) != 0) std::exit(2);
  dup2(ends[1], STDERR_FILENO);
  close(ends[1]);
  return ends;
}

void LogMany() {
  for (int i = 0; i < kManyLines; ++i) spdlog::info("event=call number={}", i);
}

// Reads until the text is there, or the other end is closed.
bool Finds(int end, const std::string& text) {
  std::string all;
  std::array<char, 4096> part{};
  for (ssize_t count = 1; count > 0 && all.find(text) == std::string::npos;) {
    count = read(end, part.data(), part.size());
    if (count > 0) all.append(part.data(), static_cast<std::size_t>(count));
  }
  return all.find(text) != std::string::npos;
}

// In processes of their own, whose standard error they replace.

TEST(BackgroundLog, WritesEveryLineUntilTheEnd) {
  EXPECT_EXIT(
      {
        StartBackgroundLog("test", "info");
        spdlog::info("event=start");
        spdlog::debug("event=detail");
        spdlog::info("event=last");
        std::exit(LostLogLines() == 0 ? 0 : 1);
      },
      ExitedWithCode(0), "level=info event=start\n.*level=info event=last\n");
}

TEST(BackgroundLog, AReaderThatDoesNotReadStopsNeitherCallsNorTheEnd) {
  EXPECT_EXIT(
      {
        PipeInPlaceOfStandardError();
        StartBackgroundLog("test", "info");
        LogMany();
        std::exit(LostLogLines() > 0 ? 0 : 1);
      },
      ExitedWithCode(0), "");
}

TEST(BackgroundLog, LostLinesAreLoggedOnceTheReaderGoesOn) {
  EXPECT_EXIT(
      {
        const PipeEnds ends = PipeInPlaceOfStandardError();
        StartBackgroundLog("test", "info");
        LogMany();
        std::exit(Finds(ends[0], "level=warning event=log_lines_lost count=") ? 0 : 1);
      },
      ExitedWithCode(0), "");
}

TEST(BackgroundLog, AReaderThatIsGoneStopsNothing) {
  EXPECT_EXIT(
      {
        close(PipeInPlaceOfStandardError()[0]);
        StartBackgroundLog("test", "info");
        LogMany();
        while (LostLogLines() < kManyLines) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        std::exit(0);
      },
      ExitedWithCode(0), "");
}

}  // namespace
}  // namespace graspdb
