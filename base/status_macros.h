// Macros that return an error to the caller. Other libraries have macros of these names: include
// this header in .cc files, and in headers that are not installed.
#pragma once

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

// RETURN_IF_ERROR(status): returns from the function if the absl::Status is an error. Of an
// absl::StatusOr: F().status().
#define RETURN_IF_ERROR(...) \
  GRASPDB_RETURN_IF_ERROR(GRASPDB_UNIQUE_NAME(status_, __COUNTER__), __VA_ARGS__)

// ASSIGN_OR_RETURN(auto value, status_or): declares `value` with the value of the absl::StatusOr,
// or returns its error from the function. Without a type it assigns to a variable that exists. A
// type must not contain a comma. These are several statements, so an `if` before them needs braces.
// A debugger shows the arguments as one line: name a longer lambda before.
#define ASSIGN_OR_RETURN(value, ...) \
  GRASPDB_ASSIGN_OR_RETURN(GRASPDB_UNIQUE_NAME(status_or_, __COUNTER__), value, __VA_ARGS__)

#define GRASPDB_RETURN_IF_ERROR(status, ...)                              \
  do {                                                                    \
    if (absl::Status status = (__VA_ARGS__); !status.ok()) return status; \
  } while (false)

// No parentheses around `value`, since it may be a declaration.
#define GRASPDB_ASSIGN_OR_RETURN(status_or, value, ...)      \
  auto status_or = (__VA_ARGS__);                            \
  if (!status_or.ok()) return std::move(status_or).status(); \
  value = *std::move(status_or)

#define GRASPDB_UNIQUE_NAME(name, number) GRASPDB_JOINED(name, number)
#define GRASPDB_JOINED(name, number) name##number
