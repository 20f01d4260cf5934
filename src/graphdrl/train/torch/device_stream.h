// Runs work for a device in order, from any thread. On the CPU at once; on CUDA in a stream of its own, without making
// the host wait.
#pragma once

#include <c10/core/Device.h>

#include <functional>
#include <memory>

namespace graphdrl {

class DeviceStream {
 public:
  // Throws Error where LibTorch does not have the device.
  explicit DeviceStream(c10::Device device);
  ~DeviceStream();

  c10::Device device() const { return device_; }

  // While it lives, LibTorch runs this thread's work in the stream.
  class Scope {
   public:
    explicit Scope(const DeviceStream& stream);
    ~Scope();
    Scope(const Scope&) = delete;

   private:
    struct Guard;
    std::unique_ptr<Guard> guard_;
  };

  // Waits until all work is done.
  void synchronize() const;

  // A point in the stream.
  class Event {
   public:
    Event();
    ~Event();
    void record(const DeviceStream& stream);
    // Waits until the stream has passed the point; not at all where none was recorded.
    void synchronize() const;

   private:
    struct Cuda;
    std::unique_ptr<Cuda> cuda_;
  };

  // Work that is the same every time, on the same tensors; its results go to tensors from outside. On CUDA, after a few
  // runs, it is captured as a CUDA graph, which launches all its kernels together.
  class CapturedWork {
   public:
    explicit CapturedWork(std::function<void()> work);
    ~CapturedWork();

    // REQUIRES: a Scope of the stream; no other thread uses the device meanwhile. Capture is global: a call such as
    // cudaMalloc from any thread would break it.
    void run(const DeviceStream& stream);

   private:
    struct Graph;
    std::function<void()> work_;
    int runs_ = 0;
    std::unique_ptr<Graph> graph_;
  };

 private:
  struct Stream;
  c10::Device device_;
  std::unique_ptr<Stream> stream_;  // none on the CPU
};

}  // namespace graphdrl
