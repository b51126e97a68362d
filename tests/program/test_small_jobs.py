# SPDX-License-Identifier: MIT
"""What a small run asks of the system, in calls: jobs in thousands are short, and the system's answers do not get quicker."""
import json
import os
import re
import shutil
import subprocess

import pytest
from conftest import drop

#: Counts calls by name and writes them when the program ends.
COUNTER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
static long opened, made, renamed, synced, written, asked, threads;
#define NEXT(type, name, ...) ((type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name))
static int count_open(const char *p, int f) {
  size_t n = strlen(p);
  if ((f & O_ACCMODE) == O_WRONLY && f & O_TRUNC) made++;
  if (n >= 5 && !strcmp(p + n - 5, "job.k")) opened++;
  return 0644; }
int open(const char *p, int f, ...) { return NEXT(int, "open", const char *, int, ...)(p, f, count_open(p, f)); }
int open64(const char *p, int f, ...) { return NEXT(int, "open64", const char *, int, ...)(p, f, count_open(p, f)); }
int rename(const char *a, const char *b) { renamed++; return NEXT(int, "rename", const char *, const char *)(a, b); }
int fsync(int f) { synced++; return NEXT(int, "fsync", int)(f); }
int fdatasync(int f) { synced++; return NEXT(int, "fdatasync", int)(f); }
ssize_t write(int f, const void *d, size_t n) {
  written++; return NEXT(ssize_t, "write", int, const void *, size_t)(f, d, n); }
int stat(const char *p, struct stat *s) { asked++; return NEXT(int, "stat", const char *, struct stat *)(p, s); }
int lstat(const char *p, struct stat *s) { asked++; return NEXT(int, "lstat", const char *, struct stat *)(p, s); }
int fstat(int f, struct stat *s) { asked++; return NEXT(int, "fstat", int, struct stat *)(f, s); }
int pthread_create(pthread_t *t, const pthread_attr_t *a, void *(*r)(void *), void *x) {
  threads++;
  return NEXT(int, "pthread_create", pthread_t *, const pthread_attr_t *, void *(*)(void *), void *)(t, a, r, x); }
__attribute__((destructor)) static void tell(void) {
  FILE *f = fopen(getenv("COUNTS"), "w");
  if (!f) return;
  fprintf(f, "{\"opened\": %ld, \"made\": %ld, \"renamed\": %ld, \"synced\": %ld, \"written\": %ld, \"asked\": %ld, \"threads\": %ld}",
          opened, made, renamed, synced, written, asked, threads);
  fclose(f); }
"""


@pytest.fixture(scope="module")
def count(exe, tmp_path_factory):
    """count(deck, words...): the calls of one run by name."""
    said = subprocess.run([exe, "--version"], capture_output=True, text=True, check=True).stdout
    compiler = shutil.which("cc") or shutil.which("gcc")
    if "-fsanitize" in said or not compiler:
        pytest.skip("needs a C compiler and no sanitisers")
    folder = tmp_path_factory.mktemp("counts")
    (folder / "counter.c").write_text(COUNTER)
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-w", "counter.c", "-o", "counter.so", "-ldl"], cwd=folder,
                   check=True)

    def run(deck, *words):
        (folder / "job.k").write_text(deck)
        variables = {**os.environ, "LD_PRELOAD": str(folder / "counter.so"), "COUNTS": str(folder / "counts.json")}
        done = subprocess.run([exe, "i=job.k", "d=out", *words], cwd=folder, env=variables, capture_output=True, text=True,
                              timeout=60, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads((folder / "counts.json").read_text())
    return run


def test_a_small_run_asks_little(count):
    """Without plot states: two files of the run's own, status, timing and what was asked for; nothing waits for the disk,
    and a mesh too small to be shared makes no threads whatever ncpu= says."""
    plain = re.sub(r"\*DATABASE_(?!GLSTAT)[^*]*", "", drop().text())
    calls = count(plain, "ncpu=2")
    assert calls["synced"] == 0 and calls["threads"] == 0, calls
    assert 3 <= calls["made"] <= 8 and calls["renamed"] <= 3, calls
    assert calls["written"] <= 80 and calls["asked"] <= 200, calls


def test_a_deck_is_read_once(count):
    assert count(drop().text(), "endtim=1e-3")["opened"] == 1


def test_what_protects_is_forced_to_the_disk(count):
    """Of a restart file, and of nothing else; plot states and histories are not."""
    assert count(drop().text())["synced"] == 0
    assert count(drop().text().replace("*END", "*DATABASE_BINARY_D3DUMP\n100,\n*END"))["synced"] > 0


def test_a_program_with_hdf5_within_needs_no_network(exe):
    """Libraries of network protocols, which come with the shared HDF5, would take longer to load than a small run."""
    needed = subprocess.run(["ldd", exe], capture_output=True, text=True, check=False).stdout
    if not needed or "libhdf5" in needed:
        pytest.skip("HDF5 is a shared library here")
    assert "libcurl" not in needed and "libcrypto" not in needed, needed
