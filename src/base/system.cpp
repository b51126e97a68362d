// SPDX-License-Identifier: MIT
// System calls: signals, exit status, memory and files. The reason of a failure is in errno.
// Handlers have no argument for a state, so that it is stored in static variables.
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

// System calls that a signal interrupts are restarted. Returns the previous handler.
static void (*set_handler(int number, void (*handler)(int)))(int) {
  struct sigaction next = {}, previous = {};
  next.sa_handler = handler;
  next.sa_flags = SA_RESTART;
  sigaction(number, &next, &previous);
  return previous.sa_handler;
}

// A pipe without reader and a file at its size limit are failed writes.
extern "C" void catch_requests() {
  set_handler(SIGUSR1, record_signal);
  set_handler(SIGUSR2, record_signal);
  set_handler(SIGPIPE, SIG_IGN);
  set_handler(SIGXFSZ, SIG_IGN);
}

// A signal that was ignored when the program started stays ignored: SIGHUP under nohup, SIGINT in a
// background job of a script.
extern "C" void catch_stops() {
  for (const int number : {SIGHUP, SIGINT})
    if (set_handler(number, SIG_IGN) != SIG_IGN) set_handler(number, record_signal);
  set_handler(SIGTERM, record_signal);
  set_handler(SIGXCPU, record_signal);
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
static bool is_exit_allowed = false; // the end is regular
static std::string last_line;
static int last_status;

static void write_text(int file, const char *text) {
  if (write(file, text, std::strlen(text)) < 0) return; // nothing is left to report it to
}

// Without Fortran units, which may be in use by the failed statement.
static void handle_exit() {
  if (is_exit_allowed) return;
  write_text(2, "slideline stopped for the reason above (error termination)\n");
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
// gfortran checks the result of malloc in `allocate`, but not in assignments that allocate and in
// copies of derived types: it would write through a null pointer. The linker redirects all
// allocations to the procedures below (--wrap); handle_exit sets the status.
extern "C" void *__real_malloc(std::size_t n);
extern "C" void *__real_calloc(std::size_t n, std::size_t size);
extern "C" void *__real_realloc(void *old, std::size_t n);

static bool is_failure_expected = false;

// Must not allocate.
static void *checked(void *block, std::size_t n) {
  if (block != nullptr || n == 0 || is_failure_expected) return block;
  char line[80];
  std::snprintf(line, sizeof line, "out of memory: %zu more bytes are not available\n", n);
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
  const std::uintptr_t page = getpagesize(), begin = reinterpret_cast<std::uintptr_t>(start);
  const std::uintptr_t first = (begin + page - 1) / page * page, last = (begin + n) / page * page;
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
    const ssize_t n_new = write(file, bytes + n_written, n - n_written); // may be a part
    if (n_new <= 0) break;
    n_written += n_new;
  }
  return n_written;
}

extern "C" int make_folder(const char *path) { return mkdir(path, 0777); }

// Read-only, as directories cannot be opened for writing.
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
