// Flags of the programs that are clients of a server: encryption, identity and retries.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "absl/status/status.h"
#include "program/tls/pem_files.h"

namespace graspdb {

// Adds the flags for the fields of client::SecurityOptions, which is not named here since it is
// installed with the client library.
template <typename SecurityOptions>
void AddSecurityFlags(CLI::App& app, SecurityOptions* options) {
  app.add_option("--ca", options->ca,
                 "File with the certificates of the authorities that sign the server's (PEM); "
                 "encrypts the connection (TLS)");
  app.add_option("--cert", options->cert,
                 "File with this client's certificate (PEM), for mutual TLS");
  app.add_option("--key", options->key, "File with the private key of --cert (PEM)");
  app.add_option("--token-file", options->token_file,
                 "File with a token that identifies this client to the server");
}

// Adds the flag for client::ConnectionOptions::busy_retries; `help` names the calls. A thousand
// take ten minutes on average; a limit doubled, twice as long.
inline void AddBusyRetriesFlag(CLI::App& app, int* retries, const std::string& help) {
  constexpr int kMaxBusyRetries = 1000;
  app.add_option("--busy-retries", *retries, help)
      ->check(CLI::Range(0, kMaxBusyRetries))
      ->capture_default_str();
}

// Why the files cannot be used for TLS, if so: FAILED_PRECONDITION.
template <typename SecurityOptions>
absl::Status CheckSecurityFiles(const SecurityOptions& options) {
  absl::Status status;
  if (!options.ca.empty()) status.Update(CheckCertificates({"--ca", options.ca}));
  if (options.cert.empty() != options.key.empty()) {
    status.Update(absl::InvalidArgumentError("--cert and --key belong together; give both"));
  } else if (!options.cert.empty()) {
    status.Update(CheckKeyPair({"--cert", options.cert}, {"--key", options.key}));
  }
  return status;
}

}  // namespace graspdb
