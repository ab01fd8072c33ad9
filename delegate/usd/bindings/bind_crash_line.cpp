#include <algorithm>
#include <array>
#include <cstddef>
#include <nanobind/stl/string.h>
#include <signal.h>
#include <string>
#include <unistd.h>

#include "delegate/usd/bindings/bindings.h"

namespace msbvh::python {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// All that the handler touches: it may call nothing that allocates or locks.
std::array<char, 8192> line;
std::size_t length = 0;
bool armed = false;
std::array<struct sigaction, kSignals.size()> before;
stack_t stack_before{};
// A stack of its own: the crash may be that of a stack that is full.
alignas(16) std::array<char, 65536> handler_stack;

extern "C" void end_with_line(int) {
  std::size_t done = 0;
  while (done < length) {
    const ssize_t written = write(STDERR_FILENO, line.data() + done, length - done);
    if (written <= 0) break;
    done += std::size_t(written);
  }
  _exit(1);
}

void set_line(const std::string& text) {
  length = std::min(text.size(), line.size());
  std::copy_n(text.data(), length, line.data());
  if (length == line.size()) line.back() = '\n';
}

void arm(const std::string& text) {
  set_line(text);
  if (armed) return;
  armed = true;
  stack_t stack{};
  stack.ss_sp = handler_stack.data();
  stack.ss_size = handler_stack.size();
  sigaltstack(&stack, &stack_before);
  struct sigaction action {};
  action.sa_handler = end_with_line;
  action.sa_flags = SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &before[i]);
}

void disarm() {
  if (!armed) return;
  armed = false;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before[i], nullptr);
  sigaltstack(&stack_before, nullptr);
}

}  // namespace

void bind_crash_line(nanobind::module_& m) {
  m.def("arm_crash_line", &arm, nanobind::arg("line"),
        "From now on a crash writes this line to stderr and ends the process with exit code 1.");
  m.def("disarm_crash_line", &disarm, "Crashes end the process as they did before.");
}

}  // namespace msbvh::python
