// A folder that may not be read; by default it may be written and traversed.
#pragma once

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

namespace graspdb {

// Gives an existing folder these permissions until the destructor, for the thread that made this.
// Modes do not apply to root, so that the thread also gives up the capabilities that pass over
// them.
class UnreadableFolder {
 public:
  explicit UnreadableFolder(std::filesystem::path folder,
                            std::filesystem::perms left = std::filesystem::perms::owner_write |
                                                          std::filesystem::perms::owner_exec)
      : folder_(std::move(folder)) {
    std::filesystem::permissions(folder_, left);
    EXPECT_EQ(syscall(SYS_capget, &header_, capabilities_.data()), 0);
    auto fewer = capabilities_;
    fewer[0].effective &= ~((1U << CAP_DAC_OVERRIDE) | (1U << CAP_DAC_READ_SEARCH));
    EXPECT_EQ(syscall(SYS_capset, &header_, fewer.data()), 0);
    std::error_code error;
    EXPECT_FALSE(std::filesystem::is_empty(folder_, error));
    EXPECT_TRUE(error == std::errc::permission_denied) << "modes do not apply here: " << error;
  }
  ~UnreadableFolder() {
    EXPECT_EQ(syscall(SYS_capset, &header_, capabilities_.data()), 0);
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
  }
  UnreadableFolder(const UnreadableFolder&) = delete;
  UnreadableFolder& operator=(const UnreadableFolder&) = delete;

 private:
  const std::filesystem::path folder_;
  __user_cap_header_struct header_ = {_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> capabilities_ = {};
};

}  // namespace graspdb
