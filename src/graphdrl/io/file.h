// Whole files in and out. Everything that the programs write goes through here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "graphdrl/io/file_lock.h"

namespace graphdrl {

// The bytes of a file. Throws Error when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// Replaces `path` with `content`, or leaves what was there: written beside it under a random name, with the mode of
// what it replaces, synced, renamed, and the folder synced. Once it returns, a power cut takes nothing of it. A link is
// followed. The first write into a folder removes what writers left there that were killed. Throws Error, also where
// something stands there that is no file, and MachineError where the disk refuses.
void write_file(const std::filesystem::path& path, std::string_view content);

// The same, and keeps what was there under the name `previous`, in the same folder. At any moment one of both is whole.
void write_file_and_keep(const std::filesystem::path& path, std::string_view content,
                         const std::filesystem::path& previous);

// Whether the files of a path can be written is io/file_check.h's. These two it shares with write_file(): the folder of
// a path, and where writing to it leads, over links whose end need not be there. Throws Error on links in a circle.
std::filesystem::path folder_of(const std::filesystem::path& path);
std::filesystem::path end_of_links(std::filesystem::path path);

// Throws what an error number of the system means for a file: MachineError where disk, memory or descriptors are not
// enough, else Error.
[[noreturn]] void fail_file(const std::filesystem::path& path, const std::string& what, int error_number);

// Creates `folder` and its parents where missing, and makes sure that files can be written there. Throws Error.
void prepare_folder(const std::filesystem::path& folder);

// A file that grows. Each text is in it whole; where append() throws, not at all, if the disk takes a part back. sync()
// makes sure that a power cut takes none of them.
class AppendedFile {
 public:
  // Of a file that is there, or a new one. Throws Error, as do the others.
  explicit AppendedFile(const std::filesystem::path& path);
  AppendedFile(AppendedFile&&) = default;
  // A new file; nothing where something has the name already, be it a link.
  static std::optional<AppendedFile> create(const std::filesystem::path& path);

  void append(std::string_view text);
  void sync();

 private:
  AppendedFile(std::filesystem::path path, Descriptor file);

  std::filesystem::path path_;
  Descriptor file_;
  std::int64_t size_ = 0;
};

}  // namespace graphdrl
