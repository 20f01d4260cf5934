#include "graphdrl/train/torch/device_queue.h"

#include <torch/torch.h>

#include <string>
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
// Libraries prepare themselves in usual runs, which a recording may not [PyTorch, "CUDA semantics", CUDA graphs].
constexpr int kUsualRuns = 3;
}  // namespace

struct DeviceQueue::Stream {
  c10::cuda::CUDAStream stream;
};

struct DeviceQueue::Scope::Guard {
  c10::cuda::CUDAStreamGuard guard;
};

struct DeviceQueue::Mark::Event {
  at::cuda::CUDAEvent event;
};

struct DeviceQueue::Repeated::Graph {
  at::cuda::CUDAGraph graph;
};

DeviceQueue::DeviceQueue(c10::Device device) : device_(device) {
  if (device.is_cpu()) return;
  if (!torch::cuda::is_available()) {
    throw Error({.what = "LibTorch finds no CUDA device", .expected = "cpu", .got = device.str(), .where = "--device"});
  }
  stream_ = std::make_unique<Stream>(Stream{c10::cuda::getStreamFromPool(/*isHighPriority=*/false, device.index())});
}

DeviceQueue::Scope::Scope(const DeviceQueue& queue) {
  if (queue.stream_) guard_.reset(new Guard{c10::cuda::CUDAStreamGuard(queue.stream_->stream)});
}

void DeviceQueue::wait() const {
  if (stream_) stream_->stream.synchronize();
}

void DeviceQueue::Mark::set(const DeviceQueue& queue) {
  if (!queue.stream_) return;
  if (!event_) event_ = std::make_unique<Event>();
  event_->event.record(queue.stream_->stream);
}

void DeviceQueue::Mark::wait() const {
  if (event_) event_->event.synchronize();
}

void DeviceQueue::Repeated::run(const DeviceQueue& queue) {
  if (graph_) return graph_->graph.replay();
  work_();
  if (!queue.stream_ || ++runs_ < kUsualRuns) return;
  // On the thread of the run before: cuBLAS prepares itself for each.
  queue.wait();
  auto graph = std::make_unique<Graph>();
  graph->graph.capture_begin();
  work_();  // recorded, not done
  graph->graph.capture_end();
  graph_ = std::move(graph);
}

#else

struct DeviceQueue::Stream {};
struct DeviceQueue::Scope::Guard {};
struct DeviceQueue::Mark::Event {};
struct DeviceQueue::Repeated::Graph {};

DeviceQueue::DeviceQueue(c10::Device device) : device_(device) {
  if (device.is_cpu()) return;
  throw Error(
      {.what = "this LibTorch is built without CUDA", .expected = "cpu", .got = device.str(), .where = "--device"});
}

DeviceQueue::Scope::Scope(const DeviceQueue&) {}

void DeviceQueue::wait() const {}

void DeviceQueue::Mark::set(const DeviceQueue&) {}

void DeviceQueue::Mark::wait() const {}

void DeviceQueue::Repeated::run(const DeviceQueue&) {
  work_();
}

#endif

DeviceQueue::~DeviceQueue() = default;
DeviceQueue::Scope::~Scope() = default;
DeviceQueue::Mark::Mark() = default;
DeviceQueue::Mark::~Mark() = default;
DeviceQueue::Repeated::Repeated(std::function<void()> work) : work_(std::move(work)) {}
DeviceQueue::Repeated::~Repeated() = default;

}  // namespace graphdrl
