// The files of maps as their readers take them.
#pragma once

#include <functional>
#include <string>

namespace graphdrl {

// The bytes of a file as its reader takes them: unpacked where they are gzipped. Pictures and arrays stay as they are.
// Texts are UTF-8 without a byte order mark, from UTF-16 too, and their lines end with "\n"; what is neither is read as
// Latin-1, with a note where the text does not say so itself. Throws Error, naming `source`, on an archive of another
// kind, and on one that is damaged or unpacks to more than a gibibyte.
std::string map_text(std::string bytes, const std::string& source, const std::function<void(const std::string&)>& note);

}  // namespace graphdrl
