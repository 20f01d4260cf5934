// The one exception type for whatever a caller can get wrong: files, options, arguments.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace graphdrl {

// The parts of one line that tells a user what to change. `expected`, `got` and `where` may be empty.
struct ErrorParts {
  std::string what;
  std::string expected = {};
  std::string got = {};
  std::string where = {};  // a file with line and column, an option, a key
};

// what() is a single printable line: "<where>: <what>: expected <expected>, got <got>".
class Error : public std::runtime_error {
 public:
  explicit Error(const ErrorParts& parts);
};

// What the machine refused, whatever the caller asked: disk, memory, threads.
class MachineError : public Error {
 public:
  using Error::Error;
};

// Another process is at work on it: later it may do.
class Busy : public Error {
 public:
  using Error::Error;
};

// `text` on one line: a path or a name may hold line breaks and terminal codes.
std::string escaped(std::string_view text);

// `text` in quotes, unprintable bytes escaped, cut to `max_length` characters.
std::string in_quotes(std::string_view text, std::size_t max_length = 60);

// A number with all digits that decide: 8888887, 0.3. At most 15, so that sums of decimals look like one.
std::string decimal(double value);

}  // namespace graphdrl
