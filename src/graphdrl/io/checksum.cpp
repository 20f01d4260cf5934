#include "graphdrl/io/checksum.h"

#include <fmt/format.h>
#define XXH_INLINE_ALL  // nothing to link with
#include <xxhash.h>

#include <memory>

namespace graphdrl {

std::string checksum(std::initializer_list<std::string_view> parts) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_64bits_reset(state.get());
  for (const std::string_view part : parts) XXH3_64bits_update(state.get(), part.data(), part.size());
  return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
}

}  // namespace graphdrl
