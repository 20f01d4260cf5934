#include "graphdrl/base/note.h"

#include <utility>

namespace graphdrl {
namespace {

std::function<void(const std::string&)>& listener() {
  static std::function<void(const std::string&)> only;
  return only;
}

}  // namespace

void listen_to_notes(std::function<void(const std::string& note)> heard) {
  listener() = std::move(heard);
}

void note(const std::string& text) {
  if (listener()) listener()(text);
}

}  // namespace graphdrl
