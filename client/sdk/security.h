// TLS and tokens; internal to the project. All functions are thread-safe.
#pragma once

#include <grpcpp/security/credentials.h>
#include <grpcpp/support/client_interceptor.h>
#include <grpcpp/support/status.h>

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "client/sdk/client.h"
#include "program/tls/watched_files.h"

namespace graspdb::client {

// INVALID_ARGUMENT for options that no connection can have, whatever the files.
absl::Status CheckUsage(const ConnectionOptions& options);

// Why no client can connect with these options: that of CheckUsage, or FAILED_PRECONDITION for
// files of TLS that are empty or not regular. Reads the sizes of the files.
absl::Status CheckOptions(const ConnectionOptions& options);

// FAILED_PRECONDITION if there is no token in its file now.
absl::Status CheckToken(const ConnectionOptions& options);

// Credentials of the files, and of what WatchTlsFiles() reads later, for new connections. For
// options that pass CheckOptions.
std::shared_ptr<grpc::ChannelCredentials> MakeCredentials(const SecurityOptions& options);

// Reads changed files of TLS again while the result lives; those of before stay in use until the
// changed ones are complete and fit each other. To be called before MakeCredentials, so that no
// change is missed between. Null without TLS.
std::unique_ptr<WatchedFiles> WatchTlsFiles(const SecurityOptions& options);

// Adds the token to every call of a channel, also without TLS, for which gRPC's own call
// credentials are not sent. Empty without a token, or if it would be sent unencrypted to another
// machine.
std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>>
MakeTokenInterceptors(const ConnectionOptions& options);

// The error of a failed call, with advice on what gRPC reports about connection and handshake.
absl::Status Explain(const grpc::Status& status, const ConnectionOptions& options);

}  // namespace graspdb::client
