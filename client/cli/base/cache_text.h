// What a server found in memory, in words.
#pragma once

#include <string>

#include "graspdb/v1/catalog_service.pb.h"

namespace graspdb::client {

// What was asked for between two looks at a cache; its bytes are as of the second.
v1::CacheStatus Between(const v1::CacheStatus& before, const v1::CacheStatus& after);

// What the whole server has in memory, of what it may.
std::string MemoryText(const v1::MemoryStatus& memory);

// "97.3 % of 4230 found, 168 of 192 MiB"
std::string CacheText(const v1::CacheStatus& cache);

// What to do about models that are often not found in a memory that is full; else empty.
std::string CacheAdvice(const v1::CacheStatus& models);

}  // namespace graspdb::client
