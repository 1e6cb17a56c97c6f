# abbe_folder(NAME [SOURCES file...] [PUBLIC target...] [PRIVATE target...] [INTERNAL header...] [OF_THE_PROGRAM])
#
# One library per folder of the architecture: target abbe_NAME, alias abbe::NAME. Headers are included
# as "NAME/file.h". Each folder is seen through a directory of its own that holds one link to it, so a
# target finds the headers of the folders it links and of no other: a wrong arrow does not build.
# All headers are installed but those that are INTERNAL, for use within the folder. A folder OF_THE_PROGRAM
# is no part of the package.
function(abbe_folder name)
  cmake_parse_arguments(arg "OF_THE_PROGRAM" "" "SOURCES;PUBLIC;PRIVATE;INTERNAL" ${ARGN})
  set(view ${PROJECT_BINARY_DIR}/view/${name})
  file(MAKE_DIRECTORY ${view})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${name} ${view}/${name} SYMBOLIC)
  if(arg_SOURCES)
    add_library(abbe_${name} STATIC ${arg_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(abbe_${name} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:abbe_warnings>)
    abbe_position_independent(abbe_${name})
    target_precompile_headers(abbe_${name} REUSE_FROM abbe_headers)
    target_compile_definitions(abbe_${name} PRIVATE EIGEN_USE_BLAS)  # as in the headers, with Eigen or without
  else()
    add_library(abbe_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(abbe::${name} ALIAS abbe_${name})
  target_link_libraries(abbe_${name} ${scope} ${arg_PUBLIC})
  target_compile_features(abbe_${name} ${scope} cxx_std_20)
  target_include_directories(abbe_${name} ${scope} $<BUILD_INTERFACE:${view}>
                             $<INSTALL_INTERFACE:include/abbe>)
  set_target_properties(abbe_${name} PROPERTIES EXPORT_NAME ${name})
  if(arg_OF_THE_PROGRAM)
    return()
  endif()
  install(TARGETS abbe_${name} EXPORT abbeTargets ARCHIVE DESTINATION lib COMPONENT development)
  set(stay_home PATTERN "node_modules" EXCLUDE)
  foreach(header IN LISTS arg_INTERNAL)
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${name}/${header})
      message(FATAL_ERROR "${name}/CMakeLists.txt: INTERNAL ${header}: there is no such header")
    endif()
    list(APPEND stay_home PATTERN "${name}/${header}" EXCLUDE)
  endforeach()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${name}/ DESTINATION include/abbe/${name}
          COMPONENT development FILES_MATCHING PATTERN "*.h" ${stay_home})
endfunction()

# For shared objects too, as the module of Python; functions are inlined as in a program.
function(abbe_position_independent target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
endfunction()

# abbe_tests(NAME LABEL label SOURCES file... LINKS target... [SEEDS n [LONG_SEEDS n]])
#
# One GoogleTest program NAME_LABEL_test; every TEST in it is the ctest entry NAME.LABEL.SUITE.TEST with
# that label. A statistical suite draws SEEDS seeds (ABBE_SEEDS); with LONG_SEEDS its tests are there a
# second time as NAME.long.SUITE.TEST, with that many. Under the sanitizers, which look at what a line does and not at how
# often, a quarter of the seeds is drawn, and each program runs as one entry, NAME.LABEL: there are a thousand and a half
# tests of a moment, and a sanitized program takes longer to start than most of them. Programs of label long are built
# only with ABBE_LONG_TESTS.
function(abbe_tests name)
  cmake_parse_arguments(arg "" "LABEL;TIMEOUT;SEEDS;LONG_SEEDS" "SOURCES;LINKS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  if(arg_LABEL STREQUAL long AND NOT ABBE_LONG_TESTS)
    return()
  endif()
  set(program ${name}_${arg_LABEL}_test)
  add_executable(${program} ${arg_SOURCES})
  if(arg_LABEL STREQUAL unit)
    add_dependencies(unit_tests ${program})
  endif()
  target_link_libraries(${program} PRIVATE ${arg_LINKS} abbe_of_tests GTest::gtest_main)
  target_precompile_headers(${program} REUSE_FROM abbe_headers_of_tests)
  abbe_register_tests(${program} ${name} ${arg_LABEL} ${arg_TIMEOUT} "${arg_SEEDS}")
  if(arg_LONG_SEEDS)
    abbe_register_tests(${program} ${name} long ${arg_TIMEOUT} ${arg_LONG_SEEDS})
  endif()
endfunction()

function(abbe_register_tests program name label timeout seeds)
  if(ABBE_SANITIZE)
    if(seeds)
      math(EXPR seeds "(${seeds} + 3) / 4")
    endif()
    add_test(NAME ${name}.${label} COMMAND ${program})
    set_tests_properties(${name}.${label} PROPERTIES LABELS ${label} TIMEOUT 900
                         ENVIRONMENT "$<$<BOOL:${seeds}>:ABBE_SEEDS=${seeds}>")
    return()
  endif()
  set(cost 10)  # suites begin before what takes a moment, so that no processor waits for the last of them
  if(label STREQUAL unit)
    set(cost 0)
  endif()
  gtest_discover_tests(${program} TEST_PREFIX "${name}.${label}." NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${label} COST ${cost} TIMEOUT ${timeout} SKIP_REGULAR_EXPRESSION "SKIPPED"
               ENVIRONMENT "$<$<BOOL:${seeds}>:ABBE_SEEDS=${seeds}>")
endfunction()

# abbe_bench(NAME LINKS target... ): one Google Benchmark program from bench/NAME.cpp.
function(abbe_bench name)
  cmake_parse_arguments(arg "" "" "LINKS" ${ARGN})
  add_executable(${name} ${name}.cpp)
  target_link_libraries(${name} PRIVATE ${arg_LINKS} benchmark::benchmark abbe_warnings
                        $<TARGET_OBJECTS:abbe_kept_memory>)
endfunction()
