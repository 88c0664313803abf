# Finds LASzip, which ships neither a CMake package nor a .pc file. Defines LASzip::LASzip.
find_path(LASzip_INCLUDE_DIR laszip/laszip_api.h)
# Not liblaszip_api: that one is a wrapper which loads the library at run time.
find_library(LASzip_LIBRARY laszip)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LASzip REQUIRED_VARS LASzip_LIBRARY LASzip_INCLUDE_DIR)
if(LASzip_FOUND AND NOT TARGET LASzip::LASzip)
  add_library(LASzip::LASzip UNKNOWN IMPORTED)
  set_target_properties(LASzip::LASzip PROPERTIES
    IMPORTED_LOCATION ${LASzip_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LASzip_INCLUDE_DIR})
endif()
mark_as_advanced(LASzip_INCLUDE_DIR LASzip_LIBRARY)
