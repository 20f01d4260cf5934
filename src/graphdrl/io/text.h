// Lines and numbers of texts.
#pragma once

#include <optional>
#include <string_view>

namespace graphdrl {

// A number that a text is, whole: "1", "-2.5e3", "+4". Empty where it is none, or not finite. -0 is 0.
std::optional<double> parse_number(std::string_view text);

// Without the spaces and tabs, or other blanks, at both ends.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t");

// The lines of a text, one by one, without their ends: "\n", "\r\n" or "\r".
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  // Goes to the next line, at first to the first one. False after the last.
  bool next();
  std::string_view line() const { return line_; }
  int number() const { return number_; }  // from 1

 private:
  std::string_view rest_;
  std::string_view line_;
  int number_ = 0;
};

}  // namespace graphdrl
