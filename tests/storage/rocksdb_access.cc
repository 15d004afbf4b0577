#include "tests/storage/rocksdb_access.h"

#include <functional>
#include <memory>
#include <vector>

#include "gtest/gtest.h"
#include "rocksdb/db.h"
#include "rocksdb/perf_context.h"
#include "storage/records.pb.h"

namespace graspdb::storage {
namespace {

using Handles = std::vector<rocksdb::ColumnFamilyHandle*>;

void Check(const rocksdb::Status& status) { ASSERT_TRUE(status.ok()) << status.ToString(); }

void WithDatabase(const std::string& directory,
                  const std::function<void(rocksdb::DB&, const Handles&)>& use) {
  std::vector<std::string> names;
  Check(rocksdb::DB::ListColumnFamilies(rocksdb::DBOptions(), directory, &names));
  std::vector<rocksdb::ColumnFamilyDescriptor> families;
  families.reserve(names.size());
  for (const std::string& name : names) {
    families.emplace_back(name, rocksdb::ColumnFamilyOptions());
  }
  rocksdb::DB* db = nullptr;
  Handles handles;
  Check(rocksdb::DB::Open(rocksdb::DBOptions(), directory, families, &handles, &db));
  const std::unique_ptr<rocksdb::DB> owner(db);
  use(*db, handles);
  for (rocksdb::ColumnFamilyHandle* handle : handles) {
    Check(db->DestroyColumnFamilyHandle(handle));
  }
  Check(db->Close());
}

rocksdb::ColumnFamilyHandle* Find(const Handles& handles, std::string_view name) {
  for (rocksdb::ColumnFamilyHandle* handle : handles) {
    if (handle->GetName() == name) return handle;
  }
  ADD_FAILURE() << "no family " << name;
  return nullptr;
}

}  // namespace

void MakeEmptyDatabase(const std::string& directory) {
  rocksdb::Options options;
  options.create_if_missing = true;
  rocksdb::DB* db = nullptr;
  Check(rocksdb::DB::Open(options, directory, &db));
  const std::unique_ptr<rocksdb::DB> owner(db);
  Check(db->Close());
}

void MakeForeignDatabase(const std::string& directory) {
  MakeEmptyDatabase(directory);
  const std::string value = "else";
  Tamper(directory, "default", "foreign", &value);
}

void SetSchemaVersion(const std::string& directory, int version) {
  WithDatabase(directory, [version](rocksdb::DB& db, const Handles& handles) {
    rocksdb::ColumnFamilyHandle* family = Find(handles, "default");
    std::string bytes;
    Check(db.Get(rocksdb::ReadOptions(), family, "meta", &bytes));
    MetaRecord meta;
    ASSERT_TRUE(meta.ParseFromString(bytes));
    meta.set_schema_version(version);
    Check(db.Put(rocksdb::WriteOptions(), family, "meta", meta.SerializeAsString()));
  });
}

void Tamper(const std::string& directory, std::string_view family, std::string_view key,
            const std::string* value) {
  WithDatabase(directory, [&](rocksdb::DB& db, const Handles& handles) {
    const rocksdb::Slice slice(key.data(), key.size());
    Check(value == nullptr ? db.Delete(rocksdb::WriteOptions(), Find(handles, family), slice)
                           : db.Put(rocksdb::WriteOptions(), Find(handles, family), slice, *value));
  });
}

void AddFamily(const std::string& directory, const std::string& name) {
  WithDatabase(directory, [&name](rocksdb::DB& db, const Handles&) {
    rocksdb::ColumnFamilyHandle* handle = nullptr;
    Check(db.CreateColumnFamily(rocksdb::ColumnFamilyOptions(), name, &handle));
    Check(db.DestroyColumnFamilyHandle(handle));
  });
}

void DropFamily(const std::string& directory, const std::string& name) {
  WithDatabase(directory, [&name](rocksdb::DB& db, const Handles& handles) {
    Check(db.DropColumnFamily(Find(handles, name)));
  });
}

void FlushToFiles(const std::string& directory) {
  WithDatabase(directory, [](rocksdb::DB& db, const Handles& handles) {
    Check(db.Flush(rocksdb::FlushOptions(), handles));
  });
}

std::uint64_t BlobsReadHere() { return rocksdb::get_perf_context()->blob_read_count; }

}  // namespace graspdb::storage
