// Says in the place of OpenBLAS that it was built without threads (to be loaded before it).
extern "C" int openblas_get_parallel() { return 0; }
