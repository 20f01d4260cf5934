// What the report page is made of: the files of report/page/ and Chart.js, put into the program at build time.
#pragma once

#include <string_view>

namespace graphdrl {

std::string_view page_template();  // HTML with {{tokens}} for what follows and for the data
std::string_view page_style();
std::string_view page_script();
std::string_view chart_library();

}  // namespace graphdrl
