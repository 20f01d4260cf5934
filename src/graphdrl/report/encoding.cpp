#include "graphdrl/report/encoding.h"

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "graphdrl/io/utf8.h"

namespace graphdrl {

std::string base64(const std::string& bytes) {
  using namespace boost::archive::iterators;
  using Letters = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  const std::string whole = bytes + std::string(padding, '\0');
  std::string text(Letters(whole.begin()), Letters(whole.end()));
  text.replace(text.size() - padding, padding, padding, '=');
  return text;
}

std::string markup(std::string_view text) {
  std::string result = valid_utf8(text);
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  boost::replace_all(result, "&", "&amp;");
  boost::replace_all(result, "<", "&lt;");
  boost::replace_all(result, ">", "&gt;");
  boost::replace_all(result, "\"", "&quot;");
  return result;
}

}  // namespace graphdrl
