# Before cpack packs what it has installed: what Debian asks of every package. Copyright and changelogs, compressed
# manual pages, static libraries without debugging symbols.
file(GLOB roots ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*)
set(packages program abbe development libabbe-dev manual abbe-doc python python3-abbe)
foreach(root IN LISTS roots)
  cmake_path(GET root FILENAME component)
  list(FIND packages ${component} place)
  math(EXPR place "${place} + 1")
  list(GET packages ${place} package)
  set(documents ${root}/usr/share/doc/${package})
  file(MAKE_DIRECTORY ${documents})
  file(COPY ${CPACK_ABBE_DOCUMENTS}/copyright ${CPACK_ABBE_DOCUMENTS}/changelog.Debian DESTINATION ${documents})
  configure_file(${CPACK_ABBE_SOURCE}/CHANGELOG.md ${documents}/changelog COPYONLY)
  if(EXISTS ${root}/usr/share/doc/abbe/html/index.html)
    file(COPY ${CPACK_ABBE_SOURCE}/packages/doc-base/abbe DESTINATION ${root}/usr/share/doc-base)
    file(RENAME ${root}/usr/share/doc-base/abbe ${root}/usr/share/doc-base/${package}.abbe)
  endif()
  file(GLOB pages ${root}/usr/share/man/man1/*.1)
  execute_process(COMMAND gzip -9 -n ${documents}/changelog.Debian ${documents}/changelog ${pages}
                  COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB libraries ${root}/usr/lib/*.a)
  if(libraries)
    execute_process(COMMAND strip --strip-debug --remove-section=.comment --remove-section=.note
                            --enable-deterministic-archives ${libraries} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  # Whatever the umask of the build was.
  execute_process(COMMAND chmod -R u=rwX,go=rX ${root} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
