#include "graphdrl/live/live_map.h"

#include <utility>

#include "graphdrl/live/live_cells.h"
#include "graphdrl/live/live_states.h"

namespace graphdrl {
namespace {

ErrorParts at_field(ErrorParts parts, const std::string& field) {
  parts.where = field;
  return parts;
}

}  // namespace

FieldError::FieldError(std::string field, ErrorParts parts)
    : Error(at_field(std::move(parts), field)), field_(std::move(field)) {}

const char* name_of(LiveStep::Done done) {
  switch (done) {
    case LiveStep::Done::kCovered:
      return "covered";
    case LiveStep::Done::kBudget:
      return "budget";
    case LiveStep::Done::kUnreachable:
      return "unreachable";
    case LiveStep::Done::kClosed:
      break;
  }
  return "closed";
}

void check_amount(double amount, const char* field) {
  constexpr double kMostAmount = 1e15;  // sums of so large ones are still exact to a tenth
  if (amount >= 0 && amount <= kMostAmount) return;
  throw FieldError(field, {.what = "bad amount", .expected = "a number from 0 to 1e15", .got = decimal(amount)});
}

std::unique_ptr<LiveMap> make_live_map(const LiveOptions& options, const LiveObservation& first) {
  if (first.at) return std::make_unique<LiveCells>(options);
  return std::make_unique<LiveStates>(options);
}

}  // namespace graphdrl
