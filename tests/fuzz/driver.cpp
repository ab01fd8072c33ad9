// Runs a target without libFuzzer: the files of its corpus, which have failed once, then so many inputs from
// a seed.
//
//   fuzz_TARGET [--count N] [--first N] [--seconds S] [FILE or FOLDER ...]
//
// Where an input fails or hangs, what it is goes to standard error and the input to crash-TARGET-N in the
// working directory: `fuzz_TARGET crash-TARGET-N` runs it again, as libFuzzer's build of the target does.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

#include "tests/fuzz/fuzzed_data.h"
#include "tests/fuzz/outcome.h"

extern "C" void __sanitizer_set_death_callback(void (*)()) __attribute__((weak));

namespace {

using Bytes = std::vector<std::uint8_t>;
namespace filesystem = std::filesystem;

constexpr unsigned kSecondsAnInput = 30;  // a hang, with room for sanitizers and a loaded machine
constexpr std::size_t kLongest = 512;

// What runs, where a signal handler finds it.
char g_target[64], g_label[512];
const Bytes* g_input = nullptr;

void save_input() {
  if (!g_input) return;
  const Bytes* input = std::exchange(g_input, nullptr);
  std::fprintf(stderr, "%s: failed on %s\n", g_target, g_label);
  if (std::FILE* file = std::fopen(g_label, "rb")) {
    std::fclose(file);  // it is a file
  } else if (std::FILE* out = std::fopen((std::string("crash-") + g_target + "-" + g_label).c_str(), "wb")) {
    std::fwrite(input->data(), 1, input->size(), out);
    std::fclose(out);
    std::fprintf(stderr, "%s: its bytes are in crash-%s-%s\n", g_target, g_target, g_label);
  }
}

void on_signal(int number) {
  if (number == SIGALRM) std::fprintf(stderr, "defect: more than %u s for an input\n", kSecondsAnInput);
  save_input();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void watch() {
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) {
    if (!__sanitizer_set_death_callback || number == SIGABRT || number == SIGALRM)
      std::signal(number, on_signal);
  }
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(save_input);
}

void run(const Bytes& input, const std::string& label) {
  std::snprintf(g_label, sizeof g_label, "%s", label.c_str());
  g_input = &input;
  alarm(kSecondsAnInput);
  LLVMFuzzerTestOneInput(input.data(), input.size());
  alarm(0);
  g_input = nullptr;
}

Bytes made(std::uint64_t number) {
  msbvh::fuzz::Stream stream(number * 0x9e3779b97f4a7c15ull + 1);
  Bytes bytes(stream.next() % kLongest);
  for (std::uint8_t& byte : bytes) byte = std::uint8_t(stream.next());
  return bytes;
}

std::size_t run_files(const filesystem::path& path) {
  std::vector<filesystem::path> files;
  if (filesystem::is_directory(path)) {
    std::ranges::copy(filesystem::directory_iterator(path), std::back_inserter(files));
    std::ranges::sort(files);
  } else {
    files.push_back(path);
  }
  for (const filesystem::path& each : files) {
    std::ifstream file(each, std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "%s: cannot be read; expected an input of the target\n", each.c_str());
      std::exit(2);
    }
    run(Bytes(std::istreambuf_iterator<char>(file), {}), each.string());
  }
  return files.size();
}

}  // namespace

int main(int argc, char** argv) {
  std::snprintf(g_target, sizeof g_target, "%s", filesystem::path(argv[0]).filename().c_str());
  watch();
  std::uint64_t first = 0, count = 0;
  double seconds = 1e9;
  std::size_t files = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool is_option = argument.starts_with("--") && i + 1 < argc;
    if (is_option && argument == "--count")
      count = std::strtoull(argv[++i], nullptr, 10);
    else if (is_option && argument == "--first")
      first = std::strtoull(argv[++i], nullptr, 10);
    else if (is_option && argument == "--seconds")
      seconds = std::strtod(argv[++i], nullptr);
    else
      files += run_files(argument);
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto spent = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::uint64_t done = 0;
  for (; done < count && spent() < seconds; ++done) run(made(first + done), std::to_string(first + done));
  std::printf("%s: %zu files and %llu inputs in %.1f s\n", g_target, files,
              static_cast<unsigned long long>(done), spent());
}
