# plantimeter_module(NAME DEPENDS modules... USES libraries... [WITHOUT sources... INSTEAD sources...]): one folder of sources
# as an object library. Sources are globbed (re-checked at each build), so that adding a file is adding a file.
find_package(OpenMP REQUIRED COMPONENTS C CXX)

set(PLANTIMETER_C_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Wmissing-prototypes
                           -Wvla -Werror)
set(PLANTIMETER_CXX_WARNINGS -Wall -Wextra -Werror)

# What arithmetic is compiled with. FMA would change last digits between machines: contraction is off. Nobody reads errno or
# traps after arithmetic: loops with roots and choices can then be vectors, and no digit changes. tests/house/floating.sh
# builds with others.
set(PLANTIMETER_ARITHMETIC -ffp-contract=off -fno-math-errno -fno-trapping-math CACHE STRING "Compiler options about arithmetic")

# What every target of the project is compiled with.
function(plantimeter_compile target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
  target_compile_definitions(${target} PRIVATE _XOPEN_SOURCE=700 _FILE_OFFSET_BITS=64
                                               PLM_VERSION="${PROJECT_VERSION}")
  target_compile_options(${target} PRIVATE ${PLANTIMETER_ARITHMETIC} -fvisibility=hidden
                                           $<$<COMPILE_LANGUAGE:C>:${PLANTIMETER_C_WARNINGS}>
                                           $<$<COMPILE_LANGUAGE:CXX>:${PLANTIMETER_CXX_WARNINGS}>)
  if(CMAKE_C_COMPILER_ID STREQUAL Clang)
    # Not every loop that asks for vectors gets them from clang; it would warn.
    target_compile_options(${target} PRIVATE -Wno-pass-failed)
  endif()
  if(PLANTIMETER_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  if(PLANTIMETER_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PLANTIMETER_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
    # C++ here (tests too) is mostly templates of CGAL and OpenMesh, which take minutes to compile: a third of the time without a
    # check at each of their pointers, and with less optimisation and debug information.
    target_compile_options(${target} PRIVATE
                           $<$<COMPILE_LANGUAGE:CXX>:-O1 -g1 -fno-sanitize=vptr,null,alignment,object-size>)
    target_link_options(${target} PRIVATE -fsanitize=${PLANTIMETER_SANITIZE})
  endif()
endfunction()

function(plantimeter_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;USES;WITHOUT;INSTEAD" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name}/*.c ${PROJECT_SOURCE_DIR}/${name}/*.cpp)
  list(TRANSFORM ARG_WITHOUT PREPEND ${PROJECT_SOURCE_DIR}/)
  list(REMOVE_ITEM sources "" ${ARG_WITHOUT})
  list(APPEND sources ${ARG_INSTEAD})
  if(NOT sources)
    file(WRITE ${PROJECT_BINARY_DIR}/generated/empty_${name}.c "typedef int plm_${name}_is_empty;\n")
    set(sources ${PROJECT_BINARY_DIR}/generated/empty_${name}.c)
  endif()
  add_library(plm_${name} OBJECT ${sources})
  plantimeter_compile(plm_${name})
  target_link_libraries(plm_${name} PUBLIC ${ARG_USES} OpenMP::OpenMP_C OpenMP::OpenMP_CXX)
  # DEPENDS are the arrows of docs/architecture.md; headers of other modules need no libraries, so nothing is linked.
  # tests/house checks that the #include lines follow them.
  set_property(GLOBAL APPEND PROPERTY PLANTIMETER_ARROWS "${name}:${ARG_DEPENDS}")
endfunction()

# One static and one shared library from the modules. The tests link the static one, so that they reach internals.
function(plantimeter_libraries)
  set(objects)
  foreach(module IN LISTS ARGN)
    list(APPEND objects $<TARGET_OBJECTS:plm_${module}>)
  endforeach()
  add_library(plantimeter_static STATIC ${objects})
  add_library(plantimeter_shared SHARED ${objects})
  foreach(target plantimeter_static plantimeter_shared)
    foreach(module IN LISTS ARGN)
      get_target_property(libraries plm_${module} LINK_LIBRARIES)
      target_link_libraries(${target} PRIVATE ${libraries})
    endforeach()
    set_target_properties(${target} PROPERTIES OUTPUT_NAME plantimeter LINKER_LANGUAGE CXX)
    target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(${target} PRIVATE OpenMP::OpenMP_C)
    if(PLANTIMETER_SANITIZE)
      target_link_options(${target} PUBLIC -fsanitize=${PLANTIMETER_SANITIZE})
    endif()
  endforeach()
  set_target_properties(plantimeter_static PROPERTIES EXPORT_NAME plantimeter_static)
  set_target_properties(plantimeter_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
endfunction()

function(plantimeter_program folder)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.c)
  set(left_out)
  if(NOT PLANTIMETER_SIMULATE)
    list(FILTER sources EXCLUDE REGEX "/(command_simulate|command_light|command_study|light_run|light_hook|study_.*)\\.c$")
    list(APPEND sources ${PROJECT_SOURCE_DIR}/${folder}/left_out/simulate.c)
    list(APPEND left_out "simulate")
  endif()
  if(NOT PLANTIMETER_GEOREFERENCE)
    list(APPEND left_out "georeference")
  endif()
  list(JOIN left_out ", " left_out)
  add_executable(plantimeter ${sources})
  plantimeter_compile(plantimeter)
  target_compile_definitions(plantimeter PRIVATE PLM_LEFT_OUT="${left_out}"
                                                 $<$<NOT:$<BOOL:${PLANTIMETER_SIMULATE}>>:PLM_WITHOUT_LIGHT>)
  target_link_libraries(plantimeter PRIVATE plantimeter_static OpenMP::OpenMP_C PkgConfig::JANSSON)
  set_target_properties(plantimeter PROPERTIES LINKER_LANGUAGE CXX RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()
