# What every folder would compile for itself, compiled once for all of them: Eigen's factorizations, and the headers from
# outside abbe that most sources include.
add_library(abbe_factorizations STATIC ${CMAKE_CURRENT_LIST_DIR}/factorizations.cpp)
add_library(abbe::factorizations ALIAS abbe_factorizations)
set_target_properties(abbe_factorizations PROPERTIES EXPORT_NAME factorizations)
install(TARGETS abbe_factorizations EXPORT abbeTargets ARCHIVE DESTINATION lib COMPONENT development)

add_library(abbe_headers OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
target_precompile_headers(abbe_headers PRIVATE <precompiled.h>)
target_include_directories(abbe_headers PRIVATE ${CMAKE_CURRENT_LIST_DIR})
target_link_libraries(abbe_headers PRIVATE fmt::fmt)

foreach(target abbe_factorizations abbe_headers)
  target_link_libraries(${target} PRIVATE Eigen3::Eigen $<BUILD_INTERFACE:abbe_warnings>)
  abbe_position_independent(${target})
endforeach()
