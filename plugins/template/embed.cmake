# cmake -DFOLDER=... -DOUT=... -P embed.cmake: writes the template's files as a C source.
function(embed symbol file)
  file(READ ${FOLDER}/${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  string(REGEX REPLACE "(('.x..',)('.x..',)('.x..',)('.x..',)('.x..',)('.x..',)('.x..',)('.x..',))"
         "\\1\n" bytes "${bytes}")
  string(APPEND code "static const char ${symbol}[] = {\n${bytes}};\n\n")
  set(code "${code}" PARENT_SCOPE)
endfunction()

set(code "/* Generated from the files beside embed.cmake. */\n#include \"template_files.h\"\n\n")
embed(project project.cmake)
foreach(kind mapping input output)
  embed(${kind}_c ${kind}.c)
  embed(${kind}_md ${kind}.md)
  set(hand ${kind})
  if(kind STREQUAL output) # it is tried with the mapping's
    set(hand mapping)
  else()
    embed(${kind}_csv ${kind}.csv)
  endif()
  string(APPEND code "const template_file template_${kind}[TEMPLATE_FILES] = {\n"
         "    {\"template_name.c\", ${kind}_c, sizeof ${kind}_c},\n"
         "    {\"CMakeLists.txt\", project, sizeof project},\n"
         "    {\"README.md\", ${kind}_md, sizeof ${kind}_md},\n"
         "    {\"take.csv\", ${hand}_csv, sizeof ${hand}_csv},\n};\n\n")
endforeach()
file(WRITE ${OUT} "${code}")
