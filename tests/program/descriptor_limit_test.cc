#include "program/connections/descriptor_limit.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <string>

namespace graspdb {
namespace {

using ::testing::ExitedWithCode;

// For processes of their own: a hard limit cannot be raised again.

[[noreturn]] void ExitWithOneUnless(bool holds) { _exit(holds ? 0 : 1); }

void SetLimits(rlim_t soft, rlim_t hard) {
  const rlimit limits = {soft, hard};
  setrlimit(RLIMIT_NOFILE, &limits);
}

TEST(DescriptorLimit, IsRaisedToTheHardOne) {
  EXPECT_EXIT(
      {
        SetLimits(64, 200);
        ExitWithOneUnless(RaiseDescriptorLimit().ok() && DescriptorLimit() == 200);
      },
      ExitedWithCode(0), "");
}

TEST(DescriptorLimit, TooFewAreAnErrorThatNamesTheSetting) {
  EXPECT_EXIT(
      {
        SetLimits(63, 63);
        const std::string text(RaiseDescriptorLimit().message());
        ExitWithOneUnless(text.find("63 open files is too low") != std::string::npos &&
                          text.find("ulimit -n") != std::string::npos);
      },
      ExitedWithCode(0), "");
}

}  // namespace
}  // namespace graspdb
