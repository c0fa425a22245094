# Builds template_name.so against marotte/plugin.h alone.
#   cmake -B build -DCMAKE_PREFIX_PATH=FOLDER    the folder marotte is installed in, if not /usr
#   cmake -B build -DMAROTTE_INCLUDE=FOLDER      or only the folder that marotte/plugin.h is in
cmake_minimum_required(VERSION 3.16)
project(template_name LANGUAGES C)

set(MAROTTE_INCLUDE "" CACHE PATH "The folder that marotte/plugin.h is in; empty: find marotte")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release) # -DCMAKE_BUILD_TYPE=Debug for a debugger
endif()
if(NOT CMAKE_C_STANDARD)
  set(CMAKE_C_STANDARD 11)
endif()
set(CMAKE_C_EXTENSIONS OFF)

add_library(plugin MODULE template_name.c)
set_target_properties(plugin PROPERTIES PREFIX "" OUTPUT_NAME template_name
                      C_VISIBILITY_PRESET hidden LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
target_compile_options(plugin PRIVATE -Wall -Wextra -Wpedantic)
if(UNIX)
  target_link_libraries(plugin PRIVATE m) # sqrtf, fminf ...
endif()
if(MAROTTE_INCLUDE)
  target_include_directories(plugin PRIVATE ${MAROTTE_INCLUDE})
  target_compile_options(plugin PRIVATE -ffp-contract=off) # same take, same bits, on every machine
else()
  find_package(marotte 0.1 REQUIRED)
  target_link_libraries(plugin PRIVATE marotte::plugin)
endif()
