// Standard input, output and error of a program.
#pragma once

#include "absl/status/status.h"

namespace graspdb {

// Opens those that the program was started without (`>&-`), so that no file or connection gets
// their numbers and with it what is printed. Reads find the end, errors go nowhere, and output
// fails, see FlushOutput(). To be called first in main(), before any thread.
void OpenStandardStreams();

// Writes what was printed. UNAVAILABLE if it, or something printed before, could not be written, as
// on a full disk.
absl::Status FlushOutput();

// The exit status of a program that has ended with `status`: 1 in place of 0 if its output could
// not be written, which it prints on stderr after the program's name.
int WithOutputWritten(const char* program, int status);

}  // namespace graspdb
