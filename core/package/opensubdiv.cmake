# The target OpenSubdiv::osdCPU. The package file of Debian's OpenSubdiv 3.5.0 names static libraries that aren't installed, and
# so finds nothing: the library and its headers (3.5 at least, with bfr) are looked for themselves.
if(NOT TARGET OpenSubdiv::osdCPU)
  find_path(OPENSUBDIV_INCLUDE_DIR opensubdiv/bfr/surface.h)
  find_library(OPENSUBDIV_CPU_LIBRARY osdCPU)
  mark_as_advanced(OPENSUBDIV_INCLUDE_DIR OPENSUBDIV_CPU_LIBRARY)
  if(OPENSUBDIV_INCLUDE_DIR AND OPENSUBDIV_CPU_LIBRARY)
    add_library(OpenSubdiv::osdCPU UNKNOWN IMPORTED GLOBAL)
    set_target_properties(OpenSubdiv::osdCPU PROPERTIES IMPORTED_LOCATION ${OPENSUBDIV_CPU_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${OPENSUBDIV_INCLUDE_DIR})
  endif()
endif()
