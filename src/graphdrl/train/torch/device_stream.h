// Runs work for a device in order, from any thread. On the CPU at once; on CUDA in a stream of its own, without making
// the host wait.
#pragma once

#include <c10/core/Device.h>

#include <functional>
#include <memory>
#include <optional>

#ifdef GRAPHDRL_TORCH_CUDA
#include <ATen/cuda/CUDAEvent.h>
#include <ATen/cuda/CUDAGraph.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#endif

namespace graphdrl {

#ifdef GRAPHDRL_TORCH_CUDA
using CudaStream = c10::cuda::CUDAStream;
using CudaGuard = c10::cuda::CUDAStreamGuard;
using CudaEvent = at::cuda::CUDAEvent;
using CudaGraph = at::cuda::CUDAGraph;
#else
// What LibTorch has with CUDA alone. There is no stream here, so nothing is asked of the others.
struct CudaStream {
  void synchronize() const {}
};
struct CudaGuard {
  explicit CudaGuard(CudaStream /*stream*/) {}
};
struct CudaEvent {
  void record(const CudaStream& /*stream*/) {}
  void synchronize() const {}
};
struct CudaGraph {
  void capture_begin() {}
  void capture_end() {}
  void replay() {}
};
#endif

class DeviceStream {
 public:
  // Throws Error where LibTorch does not have the device.
  explicit DeviceStream(c10::Device device);

  c10::Device device() const { return device_; }

  // While it lives, LibTorch runs this thread's work in the stream.
  class Scope {
   public:
    explicit Scope(const DeviceStream& stream) {
      if (stream.stream_) guard_.emplace(*stream.stream_);
    }
    Scope(const Scope&) = delete;

   private:
    std::optional<CudaGuard> guard_;
  };

  // Waits until all work is done.
  void synchronize() const {
    if (stream_) stream_->synchronize();
  }

  // A point in the stream.
  class Event {
   public:
    void record(const DeviceStream& stream) {
      if (stream.stream_) event_.record(*stream.stream_);
    }
    // Waits until the stream has passed the point; not at all where none was recorded.
    void synchronize() const { event_.synchronize(); }

   private:
    CudaEvent event_;
  };

  // Work that is the same every time, on the same tensors; its results go to tensors from outside. On CUDA, after a few
  // runs, it is captured as a CUDA graph, which launches all its kernels together.
  class CapturedWork {
   public:
    explicit CapturedWork(std::function<void()> work) : work_(std::move(work)) {}

    // REQUIRES: a Scope of the stream; no other thread uses the device meanwhile. Capture is global: a call such as
    // cudaMalloc from any thread would break it.
    void run(const DeviceStream& stream);

   private:
    std::function<void()> work_;
    int runs_ = 0;
    std::unique_ptr<CudaGraph> graph_;
  };

 private:
  c10::Device device_;
  std::optional<CudaStream> stream_;  // none on the CPU
};

}  // namespace graphdrl
