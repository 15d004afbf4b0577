#include "storage/changes/change_author.h"

#include <utility>

namespace graspdb::storage {
namespace {

thread_local const ChangeAuthor* current_author = nullptr;

}  // namespace

ChangeAuthor::ChangeAuthor(Author author) : author_(std::move(author)), outer_(current_author) {
  current_author = this;
}

ChangeAuthor::~ChangeAuthor() { current_author = outer_; }

ChangeAuthor::Author ChangeAuthor::Current() {
  return current_author == nullptr ? Author() : current_author->author_;
}

}  // namespace graspdb::storage
