#include "graphdrl/io/map_source.h"

#include <algorithm>
#include <filesystem>

#include "graphdrl/base/error.h"
#include "graphdrl/io/ascii_map.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

constexpr std::string_view kPaperLetters = "abcdefghij";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 with it

NamedMap paper_map(char letter) {
  const std::string name = std::string("paper:") + letter;
  return {name, parse_ascii_map(paper_map_text(letter), name)};
}

NamedMap file_map(const std::filesystem::path& path) {
  const std::string content = read_file(path);
  std::string_view text = content;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return {path.stem().string(), format_of(text).read(text, path.string())};
}

std::vector<NamedMap> folder_maps(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unknown;
    if (!entry->is_regular_file(unknown) || entry->path().filename().string().starts_with('.')) continue;
    files.push_back(entry->path());
  }
  if (error) throw Error({.what = "cannot read the folder (" + error.message() + ")", .where = folder.string()});
  if (files.empty()) throw Error({.what = "no map files in the folder", .where = folder.string()});
  std::sort(files.begin(), files.end());
  std::vector<NamedMap> maps;
  maps.reserve(files.size());
  for (const auto& file : files) maps.push_back(file_map(file));
  return maps;
}

}  // namespace

std::vector<NamedMap> load_maps(const std::string& source) {
  std::vector<NamedMap> maps;
  if (source == "paper") {
    for (const char letter : kPaperLetters) maps.push_back(paper_map(letter));
    return maps;
  }
  if (source.starts_with("paper:")) {
    const std::string_view letter = std::string_view(source).substr(6);
    if (letter.size() != 1 || kPaperLetters.find(letter) == std::string_view::npos) {
      throw Error({.what = "no such map", .expected = "paper:a to paper:j", .got = in_quotes(source)});
    }
    return {paper_map(letter.front())};
  }
  std::error_code error;
  if (std::filesystem::is_directory(source, error)) return folder_maps(source);
  if (std::filesystem::exists(source, error)) return {file_map(source)};
  throw Error({.what = "no such map",
               .expected = "paper, paper:a to paper:j, a file or a folder of files",
               .got = in_quotes(source, 200)});
}

NamedMap load_map(const std::string& source) {
  std::vector<NamedMap> maps = load_maps(source);
  if (maps.size() != 1) {
    throw Error(
        {.what = "more than one map", .expected = "one map", .got = std::to_string(maps.size()), .where = source});
  }
  return std::move(maps.front());
}

}  // namespace graphdrl
