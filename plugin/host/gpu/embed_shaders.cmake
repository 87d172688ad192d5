# Writes OUT, a C++ source with the text of FILES (a list separated by |, relative to ROOT) for
# shader_source.h, so that the program needs no shader files at run time.
string(REPLACE "|" ";" files "${FILES}")
set(rows "")
foreach(file ${files})
  file(READ ${ROOT}/${file} text)
  # One literal per line, because compilers may limit the length of a literal.
  string(REPLACE "\n" ")pelagic\" \"\\n\"\n    R\"pelagic(" text "${text}")
  string(APPEND rows "    {\"${file}\", R\"pelagic(${text})pelagic\"},\n")
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
