# Writes OUTPUT, a C++ file that holds the text of every shader in FILES; names are relative to src/ or shaders/.
set(text "#include \"gl/shader_source.h\"\n\nnamespace sfumato::gl {\n\nconst std::vector<ShaderFile> shader_files = {\n")
foreach(file IN LISTS FILES)
  file(READ ${file} content)
  string(REGEX REPLACE "^${ROOT}/(src|shaders)/" "" name ${file})
  string(APPEND text "    {\"${name}\",\n     R\"GLSL(${content})GLSL\"},\n")
endforeach()
string(APPEND text "};\n\n}  // namespace sfumato::gl\n")
file(WRITE ${OUTPUT} "${text}")
