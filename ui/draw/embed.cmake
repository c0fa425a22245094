# cmake -DOUT=shaders.c -DSOURCES=a.vert;b.frag -P embed.cmake: GLSL files as C arrays. Not string
# literals: C11 promises only 4095 bytes for one.
set(code "#include \"draw/gl.h\"\n")
foreach(source IN LISTS SOURCES)
  get_filename_component(file ${source} NAME)
  string(REGEX REPLACE "\\.glsl$" "" name ${file})
  string(REPLACE "." "_" name ${name})
  file(READ ${source} bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND code "static const char ${name}[] = {${bytes}};\n"
                     "const gl_source shaders_${name} = {\"${file}\", ${name}, sizeof ${name}};\n")
endforeach()
file(WRITE ${OUT} "${code}")
