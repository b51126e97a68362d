// SPDX-License-Identifier: MIT
// What the program asks of the system and the C library: signals, how it ends, memory, and files.
// Where something fails the reason is in errno. Handlers have no argument to carry a state, so that
// it is saved here.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- signals -----------------------------------------------------------------------------------
static volatile std::sig_atomic_t received[3]; // a stop, a restart file, a plot state

static void record_signal(int number) {
  received[number == SIGUSR1 ? 1 : number == SIGUSR2 ? 2 : 0] = 1;
}

// A pipe whose reader has gone and a file of the largest size allowed are failed writes.
extern "C" void catch_requests() {
  std::signal(SIGUSR1, record_signal);
  std::signal(SIGUSR2, record_signal);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

// A signal that was ignored when the program started stays so: SIGHUP under nohup, SIGINT in a job
// that a script has put behind itself.
extern "C" void catch_stops() {
  for (const int number : {SIGHUP, SIGINT})
    if (std::signal(number, SIG_IGN) != SIG_IGN) std::signal(number, record_signal);
  std::signal(SIGTERM, record_signal);
  std::signal(SIGXCPU, record_signal);
}

extern "C" void limit_processor(int seconds) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_CPU, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, seconds);
  setrlimit(RLIMIT_CPU, &limit);
}

extern "C" bool stop_requested() { return received[0] != 0; }

extern "C" bool is_requested(int request) {
  const bool yes = received[request] != 0;
  if (yes) received[request] = 0;
  return yes;
}

extern "C" bool output_is_terminal() { return isatty(1) == 1; }

// ---- ends --------------------------------------------------------------------------------------
static bool is_exit_allowed = false; // the program ends by itself
static std::string last_line;
static int last_status;

static void write_text(int file, const char *text) {
  if (write(file, text, std::strlen(text)) < 0) return; // nobody is left to be told
}

// Fortran's own units may be busy with what has failed.
static void handle_exit() {
  if (is_exit_allowed) return;
  write_text(2, "slideline could not go on, for the reason above (error termination)\n");
  write_text(1, last_line.c_str());
  _exit(last_status);
}

extern "C" void guard_exit(const char *line, int status) {
  last_line = line;
  last_status = status;
  std::atexit(handle_exit);
}

extern "C" void allow_exit() { is_exit_allowed = true; }

// ---- memory ------------------------------------------------------------------------------------
// Fortran looks at the answer of `allocate`, but not at that of assignments which allocate and of
// copies of derived types: it would write through a null pointer. The linker hands all calls for
// memory to the procedures below (--wrap); handle_exit gives the status.
extern "C" void *__real_malloc(std::size_t n);
extern "C" void *__real_calloc(std::size_t n, std::size_t size);
extern "C" void *__real_realloc(void *old, std::size_t n);

static bool is_failure_expected = false;

// Nothing here may ask for memory.
static void *checked(void *place, std::size_t n) {
  if (place != nullptr || n == 0 || is_failure_expected) return place;
  char line[80];
  std::snprintf(line, sizeof line, "the system refuses memory: %zu bytes more\n", n);
  write_text(2, line);
  std::exit(1);
}

extern "C" void *__wrap_malloc(std::size_t n) { return checked(__real_malloc(n), n); }

extern "C" void *__wrap_calloc(std::size_t n, std::size_t size) {
  const bool is_too_much = n != 0 && size > SIZE_MAX / n;
  return checked(__real_calloc(n, size), is_too_much ? SIZE_MAX : n * size);
}

extern "C" void *__wrap_realloc(void *old, std::size_t n) {
  return checked(__real_realloc(old, n), n);
}

extern "C" void expect_allocation_failure(bool yes) { is_failure_expected = yes; }

extern "C" void require_memory(std::size_t n) { std::free(checked(__real_malloc(n), n)); }

extern "C" int malloc_trim(std::size_t) __attribute__((weak)); // not every C library has it

extern "C" void release_memory() {
  if (malloc_trim != nullptr) malloc_trim(0);
}

extern "C" void release_pages(char *start, std::size_t n) {
  const std::uintptr_t page = getpagesize(), place = reinterpret_cast<std::uintptr_t>(start);
  const std::uintptr_t first = (place + page - 1) / page * page, last = (place + n) / page * page;
  if (last > first) madvise(reinterpret_cast<void *>(first), last - first, MADV_DONTNEED);
}

// ---- files -------------------------------------------------------------------------------------
struct facts {
  bool is_there, is_regular;
  int kind; // 1 directory, 2 symbolic link, 3 pipe, 4 socket, 5 device
  std::int64_t device, identity, n_name, n_byte;
};

extern "C" void find_facts(int file, const char *path, bool follows, facts *found) {
  struct stat s;
  *found = {};
  if (file >= 0 ? fstat(file, &s) : follows ? stat(path, &s) : lstat(path, &s)) return;
  const int kind = S_ISREG(s.st_mode)    ? 0
                   : S_ISDIR(s.st_mode)  ? 1
                   : S_ISLNK(s.st_mode)  ? 2
                   : S_ISFIFO(s.st_mode) ? 3
                   : S_ISSOCK(s.st_mode) ? 4
                                         : 5;
  *found = {true, kind == 0, kind, std::int64_t(s.st_dev), std::int64_t(s.st_ino),
            std::int64_t(s.st_nlink), std::int64_t(s.st_size)};
}

extern "C" void reason_text(char *text, int n) {
  const std::string reason = std::strerror(errno);
  std::memset(text, ' ', n);
  reason.copy(text, n);
}

extern "C" int open_file(const char *path, const char *mode) {
  const int flags = *mode == 'w'   ? O_WRONLY | O_CREAT | O_TRUNC
                    : *mode == 'a' ? O_WRONLY | O_CREAT | O_APPEND
                                   : O_RDWR;
  return open(path, flags, 0666);
}

extern "C" bool is_locked_by_another(int file) {
  return flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

extern "C" std::size_t write_bytes(int file, const char *bytes, std::size_t n) {
  std::size_t n_written = 0;
  while (n_written < n) {
    const ssize_t n_new = write(file, bytes + n_written, n - n_written);
    if (n_new <= 0) break;
    n_written += n_new;
  }
  return n_written;
}

extern "C" int make_folder(const char *path) { return mkdir(path, 0777); }

// A directory opens for reading alone.
extern "C" int force_path(const char *path) {
  const int file = open(path, O_RDONLY);
  if (file < 0) return -1;
  const int status = fsync(file), reason = errno, closing = close(file);
  if (status != 0) errno = reason;
  return status != 0 ? status : closing;
}

extern "C" void fill_standard_streams() {
  int file;
  do file = open("/dev/null", O_RDWR);
  while (file >= 0 && file <= 2);
  if (file > 2) close(file);
}
