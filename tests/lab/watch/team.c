/* SPDX-License-Identifier: MIT
 * The part of the OpenMP run-time library that the program uses, on plain POSIX threads.
 *
 * The thread sanitiser knows what a POSIX barrier orders and nothing of what libgomp does inside, so with
 * libgomp it takes every barrier for a race. Linked into the program, these procedures stand before those of
 * libgomp. Regions, barriers, `!$omp master`, loops of a static schedule and `taskloop` need no more: the tasks of a loop
 * run on threads of their own, as many as the team has. Whatever else the
 * program may come to use would be taken from libgomp, for which a thread of such a team is alone.
 */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { most = 64 };

typedef struct {
  void (*work)(void *);
  void *data;
  int size;
  pthread_barrier_t barrier;
} team_t;

typedef struct {
  team_t *team;
  int number;
} member_t;

/* Outside of all teams: none. */
static __thread member_t me;

static void *run_member(void *member) {
  me = *(member_t *)member;
  me.team->work(me.team->data);
  return NULL;
}

void GOMP_parallel(void (*work)(void *), void *data, unsigned size, unsigned flags) {
  team_t team = {.work = work, .data = data, .size = size > 0 ? (int)size : 2};
  pthread_t threads[most];
  member_t members[most], before = me;
  (void)flags;
  if (team.size > most || pthread_barrier_init(&team.barrier, NULL, (unsigned)team.size)) abort();
  for (int i = 1; i < team.size; i++) {
    members[i] = (member_t){&team, i};
    if (pthread_create(&threads[i], NULL, run_member, &members[i])) abort();
  }
  me = (member_t){&team, 0};
  work(data);
  for (int i = 1; i < team.size; i++) pthread_join(threads[i], NULL);
  pthread_barrier_destroy(&team.barrier);
  me = before;
}

void GOMP_barrier(void) {
  if (me.team) pthread_barrier_wait(&me.team->barrier);
}

int omp_get_thread_num(void) { return me.number; }
int omp_get_num_threads(void) { return me.team ? me.team->size : 1; }
int omp_get_num_threads_(void) { return omp_get_num_threads(); } /* as Fortran calls it */

typedef struct {
  void (*work)(void *);
  long *data; /* first and end of its part of the loop, then what it shares */
} task_t;

static void *run_task(void *task) {
  ((task_t *)task)->work(((task_t *)task)->data);
  return NULL;
}

void GOMP_taskloop(void (*work)(void *), void *data, void (*copy)(void *, void *), long size, long align, unsigned flags,
                   unsigned long n_task, int priority, long start, long end, long step) {
  pthread_t threads[most];
  task_t tasks[most];
  long n = (end - start + step - 1) / step, n_part = omp_get_num_threads(), i;
  (void)align, (void)flags, (void)n_task, (void)priority;
  if (copy) abort();
  if (n < n_part) n_part = n;
  for (i = 0; i < n_part; i++) {
    tasks[i] = (task_t){work, malloc((size_t)size)};
    if (!tasks[i].data) abort();
    memcpy(tasks[i].data, data, (size_t)size);
    tasks[i].data[0] = start + step * (n * i / n_part);
    tasks[i].data[1] = start + step * (n * (i + 1) / n_part);
    if (pthread_create(&threads[i], NULL, run_task, &tasks[i])) abort();
  }
  for (i = 0; i < n_part; i++) {
    pthread_join(threads[i], NULL);
    free(tasks[i].data);
  }
}
