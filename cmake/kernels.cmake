# Highway compiles a kernel once for each width of the processor's vectors and takes the widest that is there when the
# program runs (https://github.com/google/highway).
find_package(hwy 1.0.3 QUIET)
if(NOT hwy_FOUND)
  message(FATAL_ERROR "Highway 1.0.3 or newer is missing, the library of vector instructions: apt-get install libhwy-dev, "
                      "or give its folder of hwy-config.cmake as hwy_DIR")
endif()

# abbe_kernels(file...): sources that include themselves once for each width, and so share no unit with others. Where the
# processor has it, a product and a sum become one instruction, rounded once; nothing else of the arithmetic changes. No
# root sets errno, which headers that were compiled before do not know.
function(abbe_kernels)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
                              COMPILE_OPTIONS "-O3;-ffp-contract=fast;-fno-math-errno")
endfunction()
