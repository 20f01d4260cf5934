// Lines, fields, words, names and numbers of texts.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

// A number that a text is, whole: "1", "-2.5e3", "+4". Empty where it is none, or not finite. -0 is 0.
std::optional<double> parse_number(std::string_view text);
// The same of a whole number from `least` to `most`.
std::optional<double> parse_whole(std::string_view text, double least, double most);

// Whether two names differ in case at most.
bool same_name(std::string_view one, std::string_view other);

// Without the spaces and tabs, or other blanks, at both ends.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t");
// Takes the first word off a line, and the blanks around it. Empty where there is none.
std::string_view take_word(std::string_view& line);

// The line of a place in a text: "file:line".
std::string place_in(std::string_view text, std::size_t at, const std::string& source);

// The lines of a text, one by one, without their ends: "\n", "\r\n" or "\r".
class Lines {
 public:
  explicit Lines(std::string_view text, std::string_view source = {}) : rest_(text), source_(source) {}

  // Goes to the next line, at first to the first one. False after the last.
  bool next();
  std::string_view line() const { return line_; }
  int number() const { return number_; }  // from 1
  std::string place() const;              // "file:line"
  // Throws Error, which shows the line.
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const;

 private:
  std::string_view rest_;
  std::string_view source_;
  std::string_view line_;
  int number_ = 0;
};

// Fields of lines: CSV and what is like it.

// Empty, or beginning with '#' or '%'.
bool is_comment(std::string_view line);

// What parts the fields of a line: a tab, a semicolon or a comma where it has one outside of "quotes", else a space,
// which stands for any number of them.
char separator_of(std::string_view line);

// The fields of a line, "quotes" taken off [RFC 4180]. From '{' on all is one field, a dictionary of Python. A quote
// that does not end gives no fields.
std::vector<std::string> split_fields(std::string_view line, char separator);

// The first field that is one of these names, the first name first; case does not count. kNoColumn where none is.
inline constexpr int kNoColumn = -1;
int column_of(std::span<const std::string> fields, std::span<const std::string_view> names);

}  // namespace graphdrl
