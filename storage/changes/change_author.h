// Who changes the catalogue, for the history.
#pragma once

#include <string>

namespace graspdb::storage {

// While it exists, changes that its thread makes are by this caller. They nest; changes without one
// are of the program's own.
class ChangeAuthor {
 public:
  struct Author {
    std::string identity = {};  // empty: unknown
    std::string method = {};    // the call
  };

  explicit ChangeAuthor(Author author);
  ~ChangeAuthor();
  ChangeAuthor(const ChangeAuthor&) = delete;
  ChangeAuthor& operator=(const ChangeAuthor&) = delete;

  // That of the calling thread.
  static Author Current();

 private:
  const Author author_;
  const ChangeAuthor* const outer_;
};

}  // namespace graspdb::storage
