// Certificates and keys of a test.
#pragma once

#include <memory>
#include <string>

namespace graspdb::testing {

// PEM texts.
struct KeyPair {
  std::string certificate;
  std::string key;
};

// An authority that signs certificates with a key of its own (ECDSA, P-256).
class Authority {
 public:
  explicit Authority(const std::string& name);
  ~Authority();
  Authority(const Authority&) = delete;
  Authority& operator=(const Authority&) = delete;

  // Its own certificate, PEM.
  const std::string& certificate() const { return certificate_; }

  // A certificate for the common name and the alternative names, e.g. "DNS:localhost,IP:127.0.0.1".
  // Valid until `seconds` from now, since an hour before that time or before now.
  KeyPair Issue(const std::string& common_name, const std::string& names,
                long seconds = 3600) const;
  // The same for a server on this machine.
  KeyPair IssueForLoopback(long seconds = 3600) const {
    return Issue("server", "DNS:localhost,IP:127.0.0.1", seconds);
  }

 private:
  struct Signer;
  std::unique_ptr<Signer> signer_;
  std::string certificate_;
};

}  // namespace graspdb::testing
