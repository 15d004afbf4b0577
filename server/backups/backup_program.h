// `graspdb-server backup`: backups without a server.
#pragma once

namespace graspdb::server {

// Lists, verifies or restores the backups of a folder; argv[1] is "backup". Prints results on
// standard output and errors on standard error. Returns the exit status: 0 done, 1 failed, 2 wrong
// usage.
int RunBackupProgram(int argc, char** argv);

}  // namespace graspdb::server
