#include "graphdrl/train/run_directory.h"

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"

namespace graphdrl {

void RunDirectory::require_new() const {
  std::error_code error;
  if (!std::filesystem::exists(checkpoint(), error)) return;
  throw Error({.what = "the folder holds a run already",
               .expected = "a new folder, or --resume to go on with that run",
               .where = path_.string()});
}

void RunDirectory::create() const {
  require_new();
  prepare_folder(path_);
}

}  // namespace graphdrl
