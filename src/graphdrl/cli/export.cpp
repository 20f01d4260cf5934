#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/nn/onnx_export.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

struct ExportOptions {
  std::string policy;
  std::string out;
};

void export_policy(const ExportOptions& options) {
  const std::filesystem::path out = options.out;
  if (out.extension() != ".onnx") {
    throw Error({.what = "bad name of a model", .expected = "FILE.onnx", .got = in_quotes(options.out), .where = "-o"});
  }
  check_writable(out);
  const KnownMapPolicy policy = read_known_map_policy(options.policy);
  if (const auto* const explorer = std::get_if<SharedExplorer>(&policy)) {
    write_onnx(out, **explorer);
  } else {
    write_onnx(out, std::get<PaperParameters>(policy));
  }
}

}  // namespace

void add_export_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("export", "Write a policy's network as an ONNX model, for other runtimes");
  const auto options = std::make_shared<ExportOptions>();
  command.add_option("policy", options->policy, "A policy file, or explorer, the one in the program")
      ->required()
      ->type_name("POLICY");
  add_text_option(command, "-o,--out", options->out, "FILE.onnx", "The model to write")->required();
  command.callback([options] { export_policy(*options); });
}

}  // namespace graphdrl
