# Writes OUT, a C++ source with the text of FILES (a list separated by |, relative to ROOT) for
# shader_source.h, as it stands and as GLSL, so that the program needs no shader files at run time.

# Of an *.inl file, what shader_source.h says; of any file, without comments: #version 330 allows only ASCII.
function(to_glsl file text out)
  string(PREPEND text "\n")
  if(file MATCHES "\\.inl$")
    string(REGEX REPLACE "\n *}[ ]*//[ ]*namespace[^\n]*" "\n" text "${text}")
    string(REGEX REPLACE "\n *namespace [A-Za-z0-9_]+ {[^\n]*" "\n" text "${text}")
    string(REGEX REPLACE "\n *template *<[^>\n]*>[ ]*\n" "\n\n" text "${text}")
    string(REGEX REPLACE "//[^\n]*" "" text "${text}")
    string(REPLACE "inline " "" text "${text}")
    string(REPLACE "const T " "T " text "${text}")
    string(REPLACE "constexpr double " "const T " text "${text}")
    string(REPLACE "<T>" "" text "${text}")
    string(REGEX REPLACE "[A-Za-z0-9_]+_detail::" "" text "${text}")
    string(REGEX REPLACE "T \\(&([A-Za-z0-9_]+)\\)\\[([A-Za-z0-9_]+)\\]" "out T \\1[\\2]" text "${text}")
  else()
    string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  endif()
  string(SUBSTRING "${text}" 1 -1 text)
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# A literal for each line, because compilers may limit the length of a literal.
function(to_literals text out)
  string(REPLACE "\n" ")pelagic\" \"\\n\"\n    R\"pelagic(" text "${text}")
  set(${out} "R\"pelagic(${text})pelagic\"" PARENT_SCOPE)
endfunction()

string(REPLACE "|" ";" files "${FILES}")
set(rows "")
foreach(file ${files})
  file(READ ${ROOT}/${file} text)
  to_glsl(${file} "${text}" glsl)
  to_literals("${text}" text)
  to_literals("${glsl}" glsl)
  string(APPEND rows "    {\"${file}\", ${text},\n    ${glsl}},\n")
endforeach()
file(WRITE ${OUT} "// Made by plugin/host/gpu/embed_shaders.cmake.
#include \"plugin/host/gpu/shader_source.h\"

namespace pelagic {

const std::vector<ShaderFile>& shader_files() {
    static const std::vector<ShaderFile> files{
${rows}    };
    return files;
}

}  // namespace pelagic
")
