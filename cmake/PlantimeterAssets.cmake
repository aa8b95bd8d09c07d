# Files that the program carries: the page's style and script, the ontology mapping, and three.js where Debian's package
# libjs-three is installed (without it the report has no 3D view and says so). Each becomes bytes of a C source in the
# build folder, so that the program needs no file beside it and no network.
set(PLANTIMETER_THREE_FOLDER /usr/share/javascript/three CACHE PATH "Where three.js (build/three.min.js) lies")

# plantimeter_asset(NAME FILES...): plm_asset_NAME and its size, the bytes of FILES one behind the other, then a zero.
function(plantimeter_asset name)
  set(made ${PROJECT_BINARY_DIR}/generated/asset_${name}.c)
  add_custom_command(OUTPUT ${made}
                     COMMAND ${CMAKE_COMMAND} -DNAME=${name} "-DFILES=${ARGN}" -DMADE=${made}
                             -P ${PROJECT_SOURCE_DIR}/cmake/make_asset.cmake
                     DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/make_asset.cmake VERBATIM)
  target_sources(plm_reports PRIVATE ${made})
endfunction()

set(page ${PROJECT_SOURCE_DIR}/reports/page)
plantimeter_asset(style ${page}/report.css)
plantimeter_asset(viewer ${page}/viewer.js)
plantimeter_asset(ontology ${PROJECT_SOURCE_DIR}/reports/data/ontology.csv)
set(three ${PLANTIMETER_THREE_FOLDER}/build/three.min.js
          ${PLANTIMETER_THREE_FOLDER}/examples/js/controls/OrbitControls.js)
list(GET three 0 core)
list(GET three 1 controls)
if(EXISTS ${core} AND EXISTS ${controls})
  plantimeter_asset(three ${three})
else()
  message(STATUS "three.js (Debian: libjs-three) is not installed: reports will have no 3D view")
  plantimeter_asset(three)
endif()
