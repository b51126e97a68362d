/* SPDX-License-Identifier: MIT
 * The part of the OpenMP run-time library that the program uses, on plain POSIX threads.
 *
 * The thread sanitiser knows what a POSIX barrier orders and nothing of what libgomp does inside, so with
 * libgomp it takes every barrier for a race. Linked into the program, these procedures stand before those of
 * libgomp. Regions, barriers, `!$omp master` and loops of a static schedule need no more. Whatever else the
 * program may come to use would be taken from libgomp, for which a thread of such a team is alone.
 */
#include <pthread.h>
#include <stdlib.h>

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
