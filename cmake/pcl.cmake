# graspdb_link_pcl(TARGET PUBLIC|PRIVATE|INTERFACE part ...): parts of the Point Cloud Library. They
# are found by file: PCL's own CMake config would configure Boost, VTK, Qt and OpenNI, which are not
# used here.
function(graspdb_link_pcl target scope)
  find_path(PCL_INCLUDE_DIR pcl/pcl_base.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl REQUIRED)
  target_include_directories(${target} SYSTEM ${scope} ${PCL_INCLUDE_DIR})
  foreach(part ${ARGN})
    find_library(PCL_${part}_LIBRARY pcl_${part} REQUIRED)
    target_link_libraries(${target} ${scope} ${PCL_${part}_LIBRARY})
  endforeach()
endfunction()
