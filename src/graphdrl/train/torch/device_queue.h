// What a device is asked to do, in order, from whatever thread. On the CPU it is done at once. On CUDA it goes into a
// stream of its own, beside which the host goes on.
#pragma once

#include <c10/core/Device.h>

#include <functional>
#include <memory>

namespace graphdrl {

class DeviceQueue {
 public:
  // Throws Error where LibTorch does not have the device.
  explicit DeviceQueue(c10::Device device);
  ~DeviceQueue();

  c10::Device device() const { return device_; }

  // While it lives, LibTorch puts what this thread asks for into the queue.
  class Scope {
   public:
    explicit Scope(const DeviceQueue& queue);
    ~Scope();
    Scope(const Scope&) = delete;

   private:
    struct Guard;
    std::unique_ptr<Guard> guard_;
  };

  // Waits until all is done.
  void wait() const;

  // A place in the queue.
  class Mark {
   public:
    Mark();
    ~Mark();
    // Here. REQUIRES: a Scope of the queue.
    void set(const DeviceQueue& queue);
    // Waits until the queue has come past it; not at all where it was never set.
    void wait() const;

   private:
    struct Event;
    std::unique_ptr<Event> event_;
  };

  // The same work on the same tensors, again and again. On CUDA, after a few usual runs, it is recorded as a CUDA
  // graph, whose kernels are launched together. Results must be written to tensors from outside.
  class Repeated {
   public:
    explicit Repeated(std::function<void()> work);
    ~Repeated();

    // REQUIRES: a Scope of the queue; no thread asks the device for anything else meanwhile.
    void run(const DeviceQueue& queue);

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
