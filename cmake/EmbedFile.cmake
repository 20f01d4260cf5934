# Writes OUTPUT, a C++ source that holds the bytes of the files INPUT, one after the other, as NAME() of the header
# HEADER.
set(bytes "")
foreach(file ${INPUT})
  file(READ ${file} more HEX)
  string(APPEND bytes "${more}")
endforeach()
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
# One literal per 64 bytes, joined by the compiler.
string(REPEAT "...." 64 line)
string(REGEX REPLACE "(${line})" "\\1\"\n    \"" bytes "${bytes}")
file(WRITE ${OUTPUT} "// Made from ${INPUT} at build time.
#include \"${HEADER}\"

namespace graphdrl {

std::string_view ${NAME}() {
  static constexpr char kBytes[] =
    \"${bytes}\";
  return {kBytes, sizeof(kBytes) - 1};
}

}  // namespace graphdrl
")
