#include "program/standard_streams.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdio>

namespace graspdb {
namespace {

// In a process of its own, since it has no standard streams afterwards.
TEST(StandardStreamsDeathTest, NoFileGetsTheNumberOfAStreamThatWasClosed) {
  const auto open_one = [] {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(stream);
    OpenStandardStreams();
    const int file = open("/dev/null", O_RDONLY);
    _exit(file > STDERR_FILENO ? 0 : 1);
  };
  EXPECT_EXIT(open_one(), ::testing::ExitedWithCode(0), "");
}

TEST(StandardStreamsDeathTest, StreamsThatAreThereStay) {
  const auto print = [] {
    OpenStandardStreams();
    std::fprintf(stderr, "seen");
    _exit(0);
  };
  EXPECT_EXIT(print(), ::testing::ExitedWithCode(0), "seen");
}

TEST(StandardStreamsDeathTest, OutputThatCannotBeWrittenIsAFailure) {
  const auto print_to = [](const char* file, int status) {
    if (std::freopen(file, "w", stdout) == nullptr) _exit(99);
    std::printf("a result\n");
    _exit(WithOutputWritten("graspdb", status));
  };
  EXPECT_EXIT(print_to("/dev/null", 0), ::testing::ExitedWithCode(0), "");
  EXPECT_EXIT(print_to("/dev/full", 0), ::testing::ExitedWithCode(1),
              "graspdb: cannot write the output \\(No space left on device\\)");
  EXPECT_EXIT(print_to("/dev/full", 3), ::testing::ExitedWithCode(3), "cannot write the output");
}

TEST(StandardStreamsDeathTest, OutputOfAProgramWithoutStandardOutputIsAFailure) {
  const auto print = [] {
    close(STDOUT_FILENO);
    OpenStandardStreams();
    std::printf("a result\n");
    _exit(WithOutputWritten("graspdb", 0));
  };
  EXPECT_EXIT(print(), ::testing::ExitedWithCode(1), "graspdb: cannot write the output");
}

}  // namespace
}  // namespace graspdb
