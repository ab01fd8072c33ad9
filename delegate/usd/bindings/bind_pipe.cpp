// A pipe as a file that a library writes to: it never fills up, and no limit on file sizes applies.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <new>
#include <poll.h>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <vector>

#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using Ends = int[2];  // [0] is read, [1] written

void open_pipe(Ends& ends) {
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
}

void close_end(int& end) {
  if (end >= 0) close(end);
  end = -1;
}

// Empties the pipe on a thread of its own, which needs no GIL: a library may hold that while it writes.
class PipeReader {
 public:
  PipeReader() {
    open_pipe(data_);
    open_pipe(stop_);
    fcntl(data_[0], F_SETFL, O_NONBLOCK);
    thread_ = std::thread([this] { read_all(); });
  }
  ~PipeReader() {
    stop();
    for (int* end : {&data_[0], &stop_[0]}) close_end(*end);
  }
  PipeReader(const PipeReader&) = delete;
  PipeReader& operator=(const PipeReader&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(data_[1]); }

  // All that was written. Whoever wrote has to be done.
  nb::bytes finish() {
    {
      nb::gil_scoped_release release;
      stop();
    }
    if (out_of_memory_) throw std::bad_alloc();
    return nb::bytes(bytes_.data(), bytes_.size());
  }

 private:
  // Also where a library has left its own descriptor open, so that the pipe has no end.
  void stop() {
    for (int* end : {&data_[1], &stop_[1]}) close_end(*end);
    if (thread_.joinable()) thread_.join();
  }

  void read_all() {
    pollfd events[2] = {{data_[0], POLLIN, 0}, {stop_[0], POLLIN, 0}};
    while (true) {
      if (poll(events, 2, -1) < 0 && errno != EINTR) return;
      if (!read_some() || (events[1].revents != 0 && events[0].revents == 0)) return;
      events[0].revents = events[1].revents = 0;
    }
  }

  // What there is. False at the pipe's end.
  bool read_some() {
    char buffer[1 << 16];
    while (true) {
      const ssize_t count = read(data_[0], buffer, sizeof buffer);
      if (count == 0) return false;
      if (count < 0 && errno != EINTR) return errno == EAGAIN;
      if (count > 0 && !out_of_memory_) keep(buffer, static_cast<std::size_t>(count));
    }
  }

  // Without memory the rest is read all the same: whoever writes must not wait for ever.
  void keep(const char* bytes, std::size_t count) {
    try {
      bytes_.insert(bytes_.end(), bytes, bytes + count);
    } catch (const std::bad_alloc&) {
      out_of_memory_ = true;
    }
  }

  Ends data_ = {-1, -1};
  Ends stop_ = {-1, -1};
  std::vector<char> bytes_;
  std::atomic<bool> out_of_memory_ = false;
  std::thread thread_;
};

}  // namespace

void bind_pipe(nb::module_& m) {
  nb::class_<PipeReader>(m, "PipeReader")
      .def(nb::init<>())
      .def_prop_ro("path", &PipeReader::path)
      .def("finish", &PipeReader::finish);
}

}  // namespace msbvh::python
