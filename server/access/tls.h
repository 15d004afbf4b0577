// Encryption of the server's port.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <functional>
#include <memory>

#include "absl/status/status.h"
#include "server/access/file_state.h"
#include "server/access/tls_files.h"
#include "server/access/watched_files.h"

namespace graspdb::server {

// INVALID_ARGUMENT for flags that do not fit together, FAILED_PRECONDITION with the file that
// cannot be used.
absl::Status CheckTlsFiles(const TlsFiles& files);

// Credentials of these files, which are read again when they change; connections stay. From a
// certificate without its key until both fit again, new connections are refused. `on_refused` gets
// each client that is refused in the handshake, from any thread, with who and why.
std::shared_ptr<grpc::ServerCredentials> MakeServerCredentials(
    const TlsFiles& files, std::function<void(const absl::Status&)> on_refused);

// Logs whether changed files can be used, and notes it in `state`, which must outlive the result.
// Null without TLS.
std::unique_ptr<WatchedFiles> WatchTlsFiles(const TlsFiles& files, FileState& state);

}  // namespace graspdb::server
