// A server at a name of its machine.
#include <sys/mount.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/faults/fault_fixture.h"
#include "tests/faults/own_mounts.h"

namespace graspdb::faults {
namespace {

class HostNamesTest : public FaultTest {};

// As Debian's installer and a tool for containers may write it, each for itself.
TEST_F(HostNamesTest, AnAddressThatIsListedTwiceIsOne) {
  std::ofstream(Path("hosts")) << "127.0.0.1 localhost twice\n127.0.0.1 twice\n";
  if (!EnterOwnMounts() ||
      mount(Path("hosts").c_str(), "/etc/hosts", nullptr, MS_BIND, nullptr) != 0) {
    GTEST_SKIP() << "another /etc/hosts needs root";
  }
  std::vector<std::string> command = ServerCommand(Path("db"), "twice:0");
  command.emplace_back("--allow-remote-without-tls");
  server_ = std::make_unique<end_to_end::Process>(folder_.path(), command);
  address_ = server_->WaitForLine("listening on ");
  EXPECT_TRUE(Connect().GetCatalogStatus().ok());
  umount2("/etc/hosts", MNT_DETACH);
}

}  // namespace
}  // namespace graspdb::faults
