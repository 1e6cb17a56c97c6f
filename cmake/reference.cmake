# Target reference: the manual and the headers that the package installs as pages, by Doxygen, in reference/html of the
# build folder. Fails on what Doxygen warns of: a broken link, an unknown command, a comment of something else.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  configure_file(docs/Doxyfile.in reference/Doxyfile @ONLY)
  set(reference_input ${PROJECT_BINARY_DIR}/reference/input)
  file(MAKE_DIRECTORY ${reference_input})
  add_custom_target(reference
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${reference_input}/docs ${PROJECT_BINARY_DIR}/reference/html
    COMMAND ${Python3_EXECUTABLE} cmake/reference_input.py . ${reference_input}
    COMMAND ${CMAKE_COMMAND} -E chdir ${reference_input} doxygen ../Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Writing the reference")
  # Target site: the manual that can be searched, with the reference and a page for each cause, in site/index.html of
  # the build folder. Needs mkdocs-material, python3-matplotlib and python3-h5py.
  add_custom_target(site
    COMMAND /usr/bin/python3 -B docs/site/build_site.py --abbe $<TARGET_FILE:abbe_program>
            --reference ${PROJECT_BINARY_DIR}/reference/html --out ${PROJECT_BINARY_DIR}/site
    DEPENDS reference abbe_program
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Writing the site of the manual")
  # In the package of the manual where it has been built.
  install(DIRECTORY ${PROJECT_BINARY_DIR}/site/ DESTINATION share/doc/abbe/html COMPONENT manual OPTIONAL
          PATTERN "*.map" EXCLUDE PATTERN "sitemap.xml*" EXCLUDE)
endif()
