// How jemalloc, which graspdb-server is linked with, manages memory. Models and clouds of all sizes
// come and go on many threads; glibc's allocator holds on to twice the memory that they take.

// jemalloc reads it before anything else runs. Few arenas, and what is free goes back to the system
// within half a second, by a thread of its own.
extern "C" const char* malloc_conf;
const char* malloc_conf = "narenas:4,background_thread:true,dirty_decay_ms:500,muzzy_decay_ms:0";
