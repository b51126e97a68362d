! SPDX-License-Identifier: MIT
!> The program's own element routine, alone on one chunk that stays in the L1 cache (gather, J2 stress, hourglass,
!> forces, step limit; ns per element), and the bandwidth of the main memory (a = b + s c, GB/s counting 24 bytes an
!> entry). The unit of all times is neither: it is yardstick/, which stays as it is when this routine changes.
!> usage: bench_kernel DECK [THREADS [ENTRIES [CALLS [elastic]]]], a deck of one full chunk of quads that move (and yield,
!> where their law can and the last word is not there); the
!> bandwidth is that of THREADS threads together (1) on arrays of ENTRIES (20 million). Prints `routine_ns,...` and
!> `bandwidth_gb_s,...`, each the best of several rounds, the routine's of CALLS (20000) calls each, by processor time:
!> the machine may be shared.
program bench_kernel
  use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
  use contact_dispatch_m, only : contact_kinds
  use deck_m, only : deck_request_t, read_deck
  use element_chunk_m, only : element_chunk_t
  use errors_m, only : error_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use log_m, only : log_t
  use model_m, only : model_t
  use quad_m, only : advance_chunk
  use renumber_m, only : renumber_model
  use start_m, only : start_state
  use state_m, only : state_t
  implicit none

  integer, parameter :: n_round = 7
  type(model_t) :: model
  type(state_t) :: state
  type(deck_request_t) :: request
  type(log_t) :: log
  type(error_t), allocatable :: error
  character(:), allocatable :: effective
  character(1000) :: path
  character(20) :: word
  integer :: n_thread, n_entry, n_call
  logical :: is_elastic

  call get_command_argument(1, path)
  call get_command_argument(2, word)
  n_thread = 1
  if (word /= '') read (word, *) n_thread
  call get_command_argument(3, word)
  n_entry = 20000000
  if (word /= '') read (word, *) n_entry
  call get_command_argument(4, word)
  n_call = 20000
  if (word /= '') read (word, *) n_call
  call get_command_argument(5, word)
  is_elastic = word == 'elastic'
  request%path = trim(path)
  call read_deck(request, contact_kinds, log, model, effective, error)
  if (allocated(error)) then
    write (error_unit, '(a)') error%message
    error stop 1
  end if
  if (model%layout%n_chunk > 1) error stop 'the deck has more than one chunk of elements'
  call renumber_model(model)
  call start_state(model, log, state, error)
  if (allocated(error)) error stop 1
  write (output_unit, '(a, f0.3)') 'routine_ns,', time_routine(n_call)
  write (output_unit, '(a, f0.3)') 'bandwidth_gb_s,', measure_bandwidth(n_thread, n_entry)

contains

  !> ns per element of the best round of so many calls.
  function time_routine(n_call) result(best)
    integer, intent(in) :: n_call
    real(wp) :: best
    type(element_chunk_t) :: chunk
    real(wp) :: dt, start, finish
    integer :: i_round, i

    call advance_chunk(model, 1, model%layout%slot_nodes(1, 1), state%motion, 0.0_wp, state%elements, chunk)
    dt = 0.1_wp*state%elements%time_limit(1)
    best = huge(1.0_wp)
    do i_round = 1, n_round
      call cpu_time(start)
      do i = 1, n_call
        call advance_chunk(model, 1, model%layout%slot_nodes(1, 1), state%motion, dt, state%elements, chunk)
      end do
      call cpu_time(finish)
      best = min(best, 1.0e9_wp*(finish - start)/n_call/chunk_size)
    end do
    if (size(state%elements%history) > 0) then
      if (is_elastic .eqv. maxval(state%elements%history) > 0.0_wp) error stop 'an element yields, or none does'
    end if
  end function time_routine

  !> GB/s of the best round. Each thread is the first to touch its share of the memory.
  function measure_bandwidth(n_thread, n_entry) result(best)
    integer, intent(in) :: n_thread, n_entry !! threads, entries of each array
    real(wp) :: best
    real(wp), allocatable :: a(:), b(:), c(:)
    real(wp) :: start, finish
    integer :: i_round, i

    allocate (a(n_entry), b(n_entry), c(n_entry))
    !$omp parallel do simd schedule(static) num_threads(n_thread)
    do i = 1, n_entry
      a(i) = 0.0_wp
      b(i) = 1.0_wp
      c(i) = 2.0_wp
    end do
    best = 0.0_wp
    do i_round = 1, n_round
      call cpu_time(start)
      !$omp parallel do simd schedule(static) num_threads(n_thread)
      do i = 1, n_entry
        a(i) = b(i) + 0.5_wp*c(i)
      end do
      call cpu_time(finish)
      best = max(best, 24.0e-9_wp*n_entry*n_thread/(finish - start))
      b(i_round) = a(n_entry)
    end do
    if (.not. sum(a) > 0.0_wp) error stop 'nothing was moved'
  end function measure_bandwidth

end program bench_kernel
