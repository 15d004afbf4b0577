// Files of a database that are missing or damaged.
#pragma once

#include <string>

namespace graspdb::storage {

struct DamagedFile {
  std::string name;   // in the folder of the database
  std::string error;  // what is wrong
  bool is_lost;       // the file is missing or too short; else a read has found it damaged
};

}  // namespace graspdb::storage
