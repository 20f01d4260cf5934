#include "graphdrl/train/torch/device_stream.h"

#include <torch/torch.h>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// Before capture: libraries initialise on first use, which capture forbids [PyTorch, "CUDA semantics", CUDA graphs].
constexpr int kWarmupRuns = 3;

}  // namespace

DeviceStream::DeviceStream(c10::Device device) : device_(device) {
  if (device.is_cpu()) return;
#ifdef GRAPHDRL_TORCH_CUDA
  if (!torch::cuda::is_available()) {
    throw Error({.what = "LibTorch finds no CUDA device", .expected = "cpu", .got = device.str(), .where = "--device"});
  }
  stream_ = c10::cuda::getStreamFromPool(/*isHighPriority=*/false, device.index());
#else
  throw Error(
      {.what = "this LibTorch is built without CUDA", .expected = "cpu", .got = device.str(), .where = "--device"});
#endif
}

void DeviceStream::CapturedWork::run(const DeviceStream& stream) {
  if (graph_) return graph_->replay();
  work_();
  if (!stream.stream_ || ++runs_ < kWarmupRuns) return;
  // On the thread that has just run the work: each thread has its own cuBLAS handle, and making one cannot be captured.
  stream.synchronize();
  auto graph = std::make_unique<CudaGraph>();
  graph->capture_begin();
  try {
    work_();  // captured, not done
  } catch (...) {
    try {
      graph->capture_end();  // or the allocator would still ask the graph where memory belongs
    } catch (...) {
    }
    throw;
  }
  graph->capture_end();
  graph_ = std::move(graph);
}

}  // namespace graphdrl
