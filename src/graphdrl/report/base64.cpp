#include "graphdrl/report/base64.h"

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

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

}  // namespace graphdrl
