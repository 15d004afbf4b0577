// Settings of jemalloc, which graspdb-server links. Models and clouds of all sizes are allocated
// and freed on many threads; glibc's allocator keeps twice the memory that they need.

// jemalloc reads it before anything else runs. Few arenas, and a background thread returns free
// memory to the system within ten seconds, jemalloc's default: the memory of the next frame is then
// still mapped. With half a second a frame of 300,000 points took 10 ms longer to crop and a
// quarter longer in total where a page fault costs 10 us, as on virtual machines.
extern "C" const char* malloc_conf;
const char* malloc_conf = "narenas:4,background_thread:true,dirty_decay_ms:10000,muzzy_decay_ms:0";
