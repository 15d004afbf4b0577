// The flags for TLS.
#pragma once

#include <string>

namespace graspdb::server {

// PEM files; empty paths: none.
struct TlsFiles {
  std::string cert = {};  // certificate chain of the server; empty: no TLS
  std::string key = {};
  std::string client_ca = {};  // certificates of the authorities that sign those of clients
  bool require_client_cert = false;
};

}  // namespace graspdb::server
