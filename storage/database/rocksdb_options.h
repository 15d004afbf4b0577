// Options of RocksDB; the reasons are beside the values in the .cc.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "rocksdb/env.h"
#include "rocksdb/options.h"

namespace graspdb::storage {

// Options of the whole database. `env` is not owned; null means the default one.
rocksdb::DBOptions MakeDbOptions(rocksdb::Env* env);

// Options of the column family `name`, which may be unknown to this program.
// `write_buffer_bytes` is its memory before it is flushed to a file.
rocksdb::ColumnFamilyOptions MakeFamilyOptions(std::string_view name,
                                               std::size_t write_buffer_bytes,
                                               const std::shared_ptr<rocksdb::Cache>& block_cache);

}  // namespace graspdb::storage
