/// \file
/// Turns of Python's threads at an object that serves one of them at a time.
#pragma once

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace withy::python {

/// A mutex that refuses the thread that holds it, which would wait for itself for ever: a law in Python, or a handler
/// of a signal, that asks the simulation that it is called by.
class OneAtATime {
 public:
  /// Waits for the turn of the calling thread, and ends it. Without the interpreter, which who has the turn may need.
  class Turn {
   public:
    /// \throws std::runtime_error where it is the calling thread's turn already
    explicit Turn(OneAtATime& of) : of_(of) {
      if (of.mine())
        throw std::runtime_error("it is at work and calls this code, which cannot ask anything else of it meanwhile");
      of.mutex_.lock();
      of.holder_ = std::this_thread::get_id();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn() {
      of_.holder_ = std::thread::id();
      of_.mutex_.unlock();
    }

   private:
    OneAtATime& of_;
  };

  [[nodiscard]] bool mine() const { return holder_ == std::this_thread::get_id(); }

 private:
  std::mutex mutex_;
  std::atomic<std::thread::id> holder_;
};

}  // namespace withy::python
