# Eigen leaves large products to OpenBLAS, which has kernels for the processor it runs on: three times as
# fast as what a compiler makes for every x86-64. All code that shares Eigen's types must agree on it.
find_package(Eigen3 3.4 REQUIRED)
set(BLA_VENDOR OpenBLAS)
find_package(BLAS REQUIRED)
unset(BLA_VENDOR)
# Into every program, also those of others that use the installed libraries.
add_library(abbe_one_blas_thread OBJECT ${CMAKE_CURRENT_LIST_DIR}/one_blas_thread.cpp)
set_target_properties(abbe_one_blas_thread PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_compile_definitions(Eigen3::Eigen INTERFACE EIGEN_USE_BLAS)
target_link_libraries(Eigen3::Eigen INTERFACE abbe::factorizations $<TARGET_OBJECTS:abbe_one_blas_thread> BLAS::BLAS)
