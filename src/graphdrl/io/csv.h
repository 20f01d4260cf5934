// Lines of fields: CSV and what is like it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

inline constexpr int kNoColumn = -1;

// Empty, or beginning with '#' or '%'.
bool is_comment(std::string_view line);

// What parts the fields of a line: a tab, a semicolon or a comma where it has one outside of "quotes", else a space,
// which stands for any number of them.
char separator_of(std::string_view line);

// The fields of a line, "quotes" taken off [RFC 4180]. From '{' on all is one field, a dictionary of Python. A quote
// that does not end gives no fields.
std::vector<std::string> split_fields(std::string_view line, char separator);

// The first field that is one of these names, the first name first; case does not count. kNoColumn where none is.
int column_of(const std::vector<std::string>& fields, std::span<const std::string_view> names);

}  // namespace graphdrl
