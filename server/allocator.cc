// How jemalloc, which graspdb-server is linked with, manages memory. Models and clouds of all sizes
// come and go on many threads; glibc's allocator holds on to twice the memory that they take.

// jemalloc reads it before anything else runs. Few arenas, and what is free goes back to the system
// within ten seconds, jemalloc's default, by a thread of its own: the next frame then finds its
// memory mapped. With half a second a frame of 300,000 points took 10 ms longer to crop and a
// quarter longer in all where a page fault costs 10 us, as on virtual machines.
extern "C" const char* malloc_conf;
const char* malloc_conf = "narenas:4,background_thread:true,dirty_decay_ms:10000,muzzy_decay_ms:0";
