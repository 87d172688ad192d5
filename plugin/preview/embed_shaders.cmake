# Writes OUT, a C++ file that holds the text of FILES (a list separated by |, relative to ROOT) for
# shader_source.h, so that the program needs no file beside it.
string(REPLACE "|" ";" files "${FILES}")
set(rows "")
foreach(file ${files})
  file(READ ${ROOT}/${file} text)
  # A string literal of C++ may be cut anywhere, and compilers need not take long ones.
  string(REPLACE "\n" ")pelagic\" \"\\n\"\n    R\"pelagic(" text "${text}")
  string(APPEND rows "    {\"${file}\", R\"pelagic(${text})pelagic\"},\n")
endforeach()
file(WRITE ${OUT} "// Made by plugin/preview/embed_shaders.cmake.
#include \"plugin/preview/shader_source.h\"

namespace pelagic {

const std::vector<ShaderFile>& shader_files() {
    static const std::vector<ShaderFile> files{
${rows}    };
    return files;
}

}  // namespace pelagic
")
