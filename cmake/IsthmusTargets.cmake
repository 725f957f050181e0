# One warning set and one way to declare a module, a pipeline part or a test.
add_library(isthmus_warnings INTERFACE)
target_compile_options(isthmus_warnings INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual)
if(ISTHMUS_WARNINGS_AS_ERRORS)
  target_compile_options(isthmus_warnings INTERFACE -Werror)
endif()

# isthmus_module(NAME SOURCES a.cpp ... [PUBLIC targets] [PRIVATE targets])
# Declares the static library isthmus_NAME, alias isthmus::NAME; headers are included as "NAME/header.h".
function(isthmus_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(isthmus_${name} STATIC ${ARG_SOURCES})
  add_library(isthmus::${name} ALIAS isthmus_${name})
  set_target_properties(isthmus_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(isthmus_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/isthmus>)
  target_compile_features(isthmus_${name} PUBLIC cxx_std_20)
  target_link_libraries(isthmus_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:isthmus_warnings>)
  set_property(GLOBAL APPEND PROPERTY ISTHMUS_TARGETS isthmus_${name})
endfunction()

# isthmus_test(NAME SOURCES a.cpp ... LIBS targets [LABELS labels] [TIMEOUT seconds])
# Declares a GoogleTest program NAME and registers each of its tests with ctest.
function(isthmus_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE ISTHMUS_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
    ISTHMUS_BINARY_DIR="${CMAKE_BINARY_DIR}")
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} GTest::gtest_main isthmus_warnings)
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()
