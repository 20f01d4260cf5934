// The calls by which files change. Tests put a double in their place: it fails, or loses what was not synced.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string_view>

namespace graphdrl {

// Each does what the POSIX call of its name does; on failure it gives -1 and sets errno. Called on any thread.
class FileSystem {
 public:
  virtual ~FileSystem() = default;
  virtual int open(const char* path, int flags, mode_t mode);
  virtual ssize_t write(int descriptor, const void* data, std::size_t size);
  virtual int ftruncate(int descriptor, off_t size);
  virtual int fsync(int descriptor);  // of a file or a folder
  virtual int close(int descriptor);
  virtual int rename(const char* from, const char* to);
  virtual int unlink(const char* path);
  virtual int mkdir(const char* path, mode_t mode);
};

FileSystem& file_system();
// Puts another in the place of the machine's, which comes back with nullptr. Call it while no other thread runs.
void set_file_system(FileSystem* replacement);

// Writes all of it; gives 0, or the error number of what failed.
int write_all(int descriptor, std::string_view content);

}  // namespace graphdrl
