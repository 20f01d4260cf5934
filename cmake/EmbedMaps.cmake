# Writes OUTPUT, a C++ source that holds the map files MAPS as texts. The letter of a map is its file's name.
set(cases "")
foreach(file ${MAPS})
  get_filename_component(letter ${file} NAME_WE)
  file(READ ${file} text)
  string(REPLACE "\n" "\\n" text "${text}")
  string(APPEND cases "    case '${letter}':\n      return \"${text}\";\n")
endforeach()
file(WRITE ${OUTPUT} "// Made from maps/paper/ at build time.
#include \"graphdrl/io/map_source.h\"

namespace graphdrl {

std::string_view paper_map_text(char letter) {
  switch (letter) {
${cases}    default:
      return {};
  }
}

}  // namespace graphdrl
")
