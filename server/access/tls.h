// Encryption of the server's port.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <functional>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "program/tls/watched_files.h"
#include "server/access/file_state.h"
#include "server/access/tls_files.h"

namespace graspdb::server {

// INVALID_ARGUMENT for flags that do not fit together, FAILED_PRECONDITION with the file that
// cannot be used.
absl::Status CheckTlsFiles(const TlsFiles& files);

// Credentials of these files, and of what WatchTlsFiles() reads later, for new connections.
// `on_refused` gets each client that is refused in the handshake, from any thread, with who and
// why. The errors of TlsFileSet::Refresh().
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(
    const TlsFiles& files, std::function<void(const absl::Status&)> on_refused);

// Reads changed files again; those of before stay in use while the changed ones fail CheckTlsFiles.
// Logs which it is, and notes it in `state`, which must outlive the result. Null without TLS.
std::unique_ptr<WatchedFiles> WatchTlsFiles(const TlsFiles& files, FileState& state);

}  // namespace graspdb::server
