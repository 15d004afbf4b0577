// Cache and memory statistics of a server as text.
#pragma once

#include <cstdint>
#include <string>

#include "graspdb/v1/catalog_service.pb.h"

namespace graspdb::client {

// The requests to a cache between two statuses; its bytes are as of the second.
v1::CacheStatus Between(const v1::CacheStatus& before, const v1::CacheStatus& after);

// "34.8 MiB", in the unit that suits the size.
std::string BytesText(std::int64_t bytes);

// The memory of the whole server and its budget.
std::string MemoryText(const v1::MemoryStatus& memory);

// "97.3 % of 4230 found, 168 of 192 MiB"
std::string CacheText(const v1::CacheStatus& cache);

// Advice when the model cache is full and often misses; else empty.
std::string CacheAdvice(const v1::CacheStatus& models);

}  // namespace graspdb::client
