#include "graphdrl/train/torch/device_stream.h"

#include <torch/torch.h>

#include <utility>

#include "graphdrl/base/error.h"

#ifdef GRAPHDRL_TORCH_CUDA
#include <ATen/cuda/CUDAEvent.h>
#include <ATen/cuda/CUDAGraph.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#endif

namespace graphdrl {

#ifdef GRAPHDRL_TORCH_CUDA

namespace {
// Before capture: libraries initialise on first use, which capture forbids [PyTorch, "CUDA semantics", CUDA graphs].
constexpr int kWarmupRuns = 3;
}  // namespace

struct DeviceStream::Stream {
  c10::cuda::CUDAStream stream;
};

struct DeviceStream::Scope::Guard {
  c10::cuda::CUDAStreamGuard guard;
};

struct DeviceStream::Event::Cuda {
  at::cuda::CUDAEvent event;
};

struct DeviceStream::CapturedWork::Graph {
  at::cuda::CUDAGraph graph;
};

DeviceStream::DeviceStream(c10::Device device) : device_(device) {
  if (device.is_cpu()) return;
  if (!torch::cuda::is_available()) {
    throw Error({.what = "LibTorch finds no CUDA device", .expected = "cpu", .got = device.str(), .where = "--device"});
  }
  stream_ = std::make_unique<Stream>(Stream{c10::cuda::getStreamFromPool(/*isHighPriority=*/false, device.index())});
}

DeviceStream::Scope::Scope(const DeviceStream& stream) {
  if (stream.stream_) guard_.reset(new Guard{c10::cuda::CUDAStreamGuard(stream.stream_->stream)});
}

void DeviceStream::synchronize() const {
  if (stream_) stream_->stream.synchronize();
}

void DeviceStream::Event::record(const DeviceStream& stream) {
  if (!stream.stream_) return;
  if (!cuda_) cuda_ = std::make_unique<Cuda>();
  cuda_->event.record(stream.stream_->stream);
}

void DeviceStream::Event::synchronize() const {
  if (cuda_) cuda_->event.synchronize();
}

void DeviceStream::CapturedWork::run(const DeviceStream& stream) {
  if (graph_) return graph_->graph.replay();
  work_();
  if (!stream.stream_ || ++runs_ < kWarmupRuns) return;
  // On the thread that has just run the work: each thread has its own cuBLAS handle, and making one cannot be captured.
  stream.synchronize();
  auto graph = std::make_unique<Graph>();
  graph->graph.capture_begin();
  try {
    work_();  // captured, not done
  } catch (...) {
    try {
      graph->graph.capture_end();  // or the allocator would still ask the graph where memory belongs
    } catch (...) {
    }
    throw;
  }
  graph->graph.capture_end();
  graph_ = std::move(graph);
}

#else

struct DeviceStream::Stream {};
struct DeviceStream::Scope::Guard {};
struct DeviceStream::Event::Cuda {};
struct DeviceStream::CapturedWork::Graph {};

DeviceStream::DeviceStream(c10::Device device) : device_(device) {
  if (device.is_cpu()) return;
  throw Error(
      {.what = "this LibTorch is built without CUDA", .expected = "cpu", .got = device.str(), .where = "--device"});
}

DeviceStream::Scope::Scope(const DeviceStream&) {}

void DeviceStream::synchronize() const {}

void DeviceStream::Event::record(const DeviceStream&) {}

void DeviceStream::Event::synchronize() const {}

void DeviceStream::CapturedWork::run(const DeviceStream&) {
  work_();
}

#endif

DeviceStream::~DeviceStream() = default;
DeviceStream::Scope::~Scope() = default;
DeviceStream::Event::Event() = default;
DeviceStream::Event::~Event() = default;
DeviceStream::CapturedWork::CapturedWork(std::function<void()> work) : work_(std::move(work)) {}
DeviceStream::CapturedWork::~CapturedWork() = default;

}  // namespace graphdrl
