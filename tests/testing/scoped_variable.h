// A variable of the environment for the time of a test.
#pragma once

#include <cstdlib>
#include <string>

namespace graspdb::testing {

class ScopedVariable {
 public:
  // Not set.
  explicit ScopedVariable(const char* name) : name_(name) {
    const char* before = std::getenv(name);
    if (before != nullptr) before_ = before;
    was_set_ = before != nullptr;
    unsetenv(name);
  }
  ScopedVariable(const char* name, const std::string& value) : ScopedVariable(name) {
    setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() {
    if (was_set_) {
      setenv(name_, before_.c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* const name_;
  std::string before_;
  bool was_set_ = false;
};

// Whatever proxy the machine of the test has.
struct NoProxy {
  ScopedVariable grpc{"grpc_proxy"};
  ScopedVariable https{"https_proxy"};
  ScopedVariable http{"http_proxy"};
  ScopedVariable grpc_exceptions{"no_grpc_proxy"};
  ScopedVariable exceptions{"no_proxy"};
};

}  // namespace graspdb::testing
