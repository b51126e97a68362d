! SPDX-License-Identifier: MIT
!> Results file `<job>.vtkhdf`: states for VTK, ParaView and PyVista (VTKHDF 2.0, transient
!> unstructured grid), histories and run data. The layout is described in doc/results.md; only this
!> folder and the reader of the Python tools depend on it.
!>
!> The mesh is stored once; each state appends rows to the arrays. All data of a state are handed to
!> the system before they are counted: whenever the process is killed, the file opens with the
!> states before (see results_arrays_m). A restart copies the states before it from the file of the
!> earlier run into a new one, which then replaces the old one in one step.
module results_file_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use archive_m, only : archive_t, is_hard, own_layout
  use hdf5, only : hid_t, hsize_t, H5F_ACC_RDONLY_F, H5F_SCOPE_LOCAL_F, H5T_STD_I64LE, h5awrite_f, &
    h5aclose_f, h5fflush_f, h5fclose_f, h5fopen_f, h5close_f, h5lexists_f, h5screate_simple_f
  use kinds_m, only : wp, long
  use contacts_m, only : has_shear
  use errors_m, only : error_t, raise, status_files, status_input
  use files_m, only : file_facts_t, facts_of_name, is_same_file, file_exists, lengthen_file, &
    remove_file, rename_file, unfinished
  use model_m, only : model_t, is_sheet
  use parts_m, only : has_memory_of_heat
  use snapshot_m, only : snapshot_t
  use history_file_m, only : histories_t
  use results_arrays_m, only : results_file_t, create_file, create_steps, create_fields, &
    planned_states, block_rows, fields, n_step_array, step_values, step_points, step_ones, &
    run_info_t, write_mesh, write_run, write_histories, deck_nodes
  use hdf5_writing_m, only : growing_t, as_index, open_library, end_of_file, append_rows, &
    open_growing, read_rows, close_growing, text_attribute, write_attribute, check_status, &
    memory_type
  implicit none
  private
  public :: results_file_t, run_info_t, open_results, append_state, publish, finish_results, &
    check_old_results, copy_states

contains

  !> Create the file with the mesh and without a state. It has its final name from the first state
  !> on, and `<path>.part` before, so that a file of the final name always opens. A file of that
  !> name from an earlier run is removed, unless its states are taken over.
  subroutine open_results(file, path, model, run_info, is_restart, error)
    type(results_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(model_t), intent(in) :: model
    type(run_info_t), intent(in) :: run_info
    logical, intent(in) :: is_restart   !! an existing file stays for now
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: tree
    integer(long), target :: version(2)
    integer(hid_t) :: space
    integer :: status, n_planned, i
    logical :: has(7)

    n_planned = planned_states(model%controls)
    file%path = path
    if (.not. is_restart) call remove_file(path, error)
    if (allocated(error)) return
    allocate (file%times(n_planned))
    has = [.true., any(has_shear(model%contacts)), model%is_axisymmetric, &
      any(has_memory_of_heat(model%materials)), model%erodes, is_sheet(model), &
      model%controls%output%has_errors] ! by the needs
    file%which = pack([(i, i=1, size(fields))], has(fields%needs))
    call create_file(file, error)
    if (allocated(error)) return
    tree%id = file%id
    tree%folder = ''
    call tree%enter('VTKHDF')
    call create_steps(file, tree, n_planned)
    call create_fields(file, tree, model%mesh, n_planned)
    call text_attribute(file%id, 'VTKHDF', 'Type', 'UnstructuredGrid', .true., tree%error)
    version = [2, 0]
    call h5screate_simple_f(1, [2_hsize_t], space, status)
    call write_attribute(file%id, 'VTKHDF', 'Version', [memory_type(as_index), H5T_STD_I64LE], &
      space, c_loc(version), tree%error)
    call write_mesh(tree, model)
    call tree%leave()
    call write_run(tree, run_info)
    call tree%enter('history')
    call move_alloc(tree%error, error)
    call publish(file, error)
    allocate (file%rows(3*min(max(model%mesh%n_node, model%mesh%n_element), block_rows)))
    call mark_broken(file, error)
  end subroutine open_results

  !> Append one state and make it visible as a whole.
  subroutine append_state(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in), target :: snapshot
    type(error_t), allocatable, intent(out) :: error

    if (file%id < 0 .or. file%is_broken) return
    call check_untouched(file, error)
    call append_fields(file, model, snapshot, error)
    call append_instant(file, model, snapshot%time, error)
    call give_final_name(file, error)
    call mark_broken(file, error)
  end subroutine append_state

  !> Count the rows that have been appended to the fields as a state.
  subroutine append_instant(file, model, instant, error)
    type(results_file_t), intent(inout) :: file
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: instant                    !! its time
    type(error_t), allocatable, intent(inout) :: error
    real(wp), target :: time(1)
    integer(long), target :: numbers(4)
    integer :: i

    call flush_file(file, error)
    time = instant
    numbers = [file%n_state*model%mesh%n_node, file%n_state*model%mesh%n_element, 0_long, 1_long]
    call append_rows(file%steps(step_values), 1, c_loc(time), error)
    do i = step_points, step_ones
      call append_rows(file%steps(i), 1, c_loc(numbers(i - 1)), error)
    end do
    if (allocated(error)) return
    if (file%n_state == size(file%times)) file%times = [file%times, file%times]
    file%n_state = file%n_state + 1
    file%times(file%n_state) = instant
    call publish(file, error)
  end subroutine append_instant

  !> Rename the file to its final name.
  subroutine give_final_name(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error) .or. file%is_named) return
    call rename_file(file%path//unfinished, file%path, error)
    file%is_named = .not. allocated(error)
  end subroutine give_final_name

  !> Append the fields, nodes in deck order; missing components are zero. Stress is xx yy zz xy yz
  !> xz, in axisymmetric models zz is the hoop stress.
  subroutine append_fields(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in), target :: snapshot
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: places(:)
    integer :: i, k, m, first, n, n_row

    do k = 1, size(file%which)
      i = file%which(k)
      if (fields(i)%name == 'CellData/stress') then
        call append_rows(file%fields(i), size(snapshot%stress, 2), c_loc(snapshot%stress), error)
        cycle
      end if
      n_row = merge(model%mesh%n_element, model%mesh%n_node, fields(i)%of_cells)
      file%rows = 0.0_wp
      do first = 1, n_row, block_rows
        n = min(block_rows, n_row - first + 1)
        places = [(m, m=first, first + n - 1)]
        if (.not. fields(i)%of_cells) places = deck_nodes(model%mesh, first, n)
        call gather_rows(fields(i)%name, places, model, snapshot, file%rows)
        call append_rows(file%fields(i), n, c_loc(file%rows), error)
      end do
    end do
  end subroutine append_fields

  !> Rows of a field at some nodes or elements. Von Mises stress is sqrt(3/2 s:s).
  pure subroutine gather_rows(name, places, model, shot, rows)
    character(*), intent(in) :: name
    integer, intent(in), contiguous :: places(:)
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: shot
    real(wp), intent(inout), contiguous :: rows(:)
    integer :: i

    select case (name)
    case ('Points')
      do i = 1, size(places)
        rows(3*i - 2:3*i - 1) = model%mesh%coordinates(:, places(i)) &
          + shot%displacement(:, places(i))
      end do
    case ('PointData/displacement'); call gather(places, 2, 3, rows, shot%displacement)
    case ('PointData/velocity'); call gather(places, 2, 3, rows, shot%velocity)
    case ('PointData/contact_force'); call gather(places, 2, 3, rows, shot%contact_force)
    case ('PointData/contact_pressure'); call gather(places, 1, 1, rows, shot%contact_pressure)
    case ('PointData/gap'); call gather(places, 1, 1, rows, shot%gap)
    case ('PointData/contact_traction'); call gather(places, 1, 1, rows, shot%contact_traction)
    case ('PointData/contact_slip'); call gather(places, 1, 1, rows, shot%contact_slip)
    case ('PointData/contact_state'); call gather(places, 1, 1, rows, shot%contact_state)
    case ('CellData/plastic_strain'); call gather(places, 1, 1, rows, shot%plastic_strain)
    case ('CellData/hoop_strain'); call gather(places, 1, 1, rows, shot%hoop_strain)
    case ('CellData/thickness_strain')
      call gather(places, 1, 1, rows, shot%thickness_strain)
    case ('CellData/error'); call gather(places, 1, 1, rows, shot%error)
    case ('CellData/temperature'); call gather(places, 1, 1, rows, shot%temperature)
    case ('CellData/damage'); call gather(places, 1, 1, rows, shot%damage)
    case ('CellData/eroded'); call gather(places, 1, 1, rows, shot%eroded)
    case ('CellData/pressure')
      do i = 1, size(places)
        rows(i) = -sum(shot%stress(:3, places(i)))/3.0_wp
      end do
    case ('CellData/mises')
      do i = 1, size(places)
        associate (s => shot%stress(:, places(i)))
          rows(i) = sqrt(0.5_wp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2) &
            + 3.0_wp*s(4)**2)
        end associate
      end do
    end select
  end subroutine gather_rows

  !> Gather values at some nodes or elements; columns beyond the components stay, and all where
  !> there are no values.
  pure subroutine gather(places, n_component, n_column, rows, values)
    integer, intent(in), contiguous :: places(:)
    integer, intent(in) :: n_component, n_column
    real(wp), intent(inout) :: rows(n_column, *)
    real(wp), intent(in), optional :: values(n_component, *)
    integer :: i

    if (.not. present(values)) return
    do i = 1, size(places)
      rows(:n_component, i) = values(:, places(i))
    end do
  end subroutine gather

  !> Write the number of states and flush the file.
  subroutine publish(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    integer(long), target :: number
    integer :: status

    if (allocated(error)) return
    number = file%n_state
    call h5awrite_f(file%n_steps, memory_type(as_index), c_loc(number), status)
    call check_status(status, 'NSteps', error)
    call flush_file(file, error)
  end subroutine publish

  !> Check that the file still exists under its name and is as the last flush left it.
  subroutine check_untouched(file, error)
    type(results_file_t), intent(in) :: file
    type(error_t), allocatable, intent(inout) :: error
    type(file_facts_t) :: now

    if (allocated(error) .or. .not. file%facts%is_there) return
    now = facts_of_name(present_path(file))
    if (.not. is_same_file(now, file%facts)) then
      call raise(error, 'it has been removed or renamed during the run', status_files)
    else if (now%n_byte /= file%facts%n_byte) then
      call raise(error, 'another process has changed it during the run', status_files)
    end if
  end subroutine check_untouched

  !> Current name of the file.
  pure function present_path(file) result(path)
    type(results_file_t), intent(in) :: file
    character(:), allocatable :: path

    path = file%path
    if (.not. file%is_named) path = path//unfinished
  end function present_path

  !> Flush the file. HDF5 writes the length of the file before it extends it: if that is refused
  !> (file size limit), earlier states could not be read. So the file is extended first.
  subroutine flush_file(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    integer :: status
    logical :: has_room

    if (allocated(error)) return
    call lengthen_file(present_path(file), end_of_file(file%id), has_room)
    status = -1
    if (has_room) call h5fflush_f(file%id, H5F_SCOPE_LOCAL_F, status)
    call check_status(status, 'a state', error)
    file%facts = facts_of_name(present_path(file))
  end subroutine flush_file

  !> After a failure put the file name before the message and leave the file as the last flush left
  !> it. Closing it would make HDF5 try again and crash.
  subroutine mark_broken(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(error)) return
    error%message = file%path//': '//error%message
    file%is_broken = .true.
  end subroutine mark_broken

  !> Write the histories and close the file, if it is open and no write has failed.
  subroutine finish_results(file, histories, error)
    type(results_file_t), intent(inout) :: file
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: tree
    integer :: i, status

    if (file%id < 0 .or. file%is_broken) return
    call check_untouched(file, tree%error)
    tree%id = file%id
    tree%folder = ''
    call write_histories(tree, histories)
    call move_alloc(tree%error, error)
    call flush_file(file, error)
    if (.not. allocated(error)) then
      call h5aclose_f(file%n_steps, status)
      do i = 1, size(fields)
        call close_growing(file%fields(i), error)
      end do
      do i = 1, n_step_array
        call close_growing(file%steps(i), error)
      end do
      call h5fclose_f(file%id, status)
      file%id = -1
      call check_status(status, 'the end of the file', error)
      call h5close_f(status)
    end if
    call give_final_name(file, error)
    call mark_broken(file, error)
  end subroutine finish_results

  !> Check for a results file to take states from. A file without the states of these times is an
  !> error: it belongs to another run and would be lost.
  subroutine check_old_results(path, n_node, times, found, error)
    character(*), intent(in) :: path
    integer, intent(in) :: n_node
    real(wp), intent(in) :: times(:)
    logical, intent(out) :: found
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: unread
    type(growing_t) :: array
    character(len(fields%name)) :: names(2 + size(fields))
    real(wp), target :: stored(max(size(times), 1))
    integer(hid_t) :: id
    integer :: status, i
    logical :: fits

    found = file_exists(path)
    if (.not. found) return
    names = [character(len(names)) :: 'Steps/Values', 'PointData/node_id', fields%name]
    call open_library(status)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, id, status)
    fits = status >= 0
    do i = 1, size(names)
      if (allocated(error) .or. .not. fits) exit
      call open_own(id, 'VTKHDF/'//trim(names(i)), path, array, error)
      if (allocated(error)) exit
      if (i == 1) then
        fits = array%id >= 0 .and. array%n_row >= size(times)
        if (fits .and. size(times) > 0) then
          call read_rows(array, 0_long, size(times), c_loc(stored), unread)
          fits = .not. allocated(unread)
          if (fits) fits = all(.not. abs(stored(:size(times)) - times) > 0.0_wp)
        end if
      else if (i == 2) then
        fits = array%id >= 0 .and. array%n_row == n_node
      end if
      call close_growing(array, error)
    end do
    if (status >= 0) call h5fclose_f(id, status)
    if (.not. (fits .or. allocated(error))) call raise(error, &
      path//' does not contain the states ' &
      //'before the restart: it belongs to another run or is damaged; move it, or choose another ' &
      //'folder with d=', status_input)
  end subroutine check_old_results

  !> Open an array of a results file, if it exists. An array stored elsewhere (link to another file,
  !> virtual dataset, external storage) is refused, since it would be copied into the results of
  !> this run.
  subroutine open_own(id, name, path, array, error)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: name, path !! of the array; of the file, for messages
    type(growing_t), intent(out) :: array
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(archive_t) :: file
    integer :: n, status
    logical :: is_own, found

    file%id = id
    file%folder = ''
    is_own = .true.
    found = .true.
    n = 0
    do while (n <= len(name) .and. found .and. is_own) ! the groups that it lies in, and itself
      n = n + index(name(n + 1:)//'/', '/')
      call h5lexists_f(id, name(:n - 1), found, status)
      if (found) is_own = is_hard(file, name(:n - 1))
    end do
    if (found .and. is_own) call open_growing(id, name, 0, array)
    if (array%id >= 0) is_own = own_layout(array%id) >= 0
    if (is_own) return
    call close_growing(array, ignored)
    call raise(error, path//' is refused: its '//name//' is not stored in it, but a link, a ' &
      //'virtual dataset or external storage; move it, or choose another folder with d=', &
      status_input)
  end subroutine open_own

  !> Copy the states of these times from the old file into the new one, which then takes its name.
  !> The old file must have passed `check_old_results`.
  subroutine copy_states(file, model, times, error)
    type(results_file_t), intent(inout) :: file
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: times(:)
    type(error_t), allocatable, intent(out) :: error
    type(growing_t) :: array
    real(wp), allocatable, target :: rows(:)
    integer(hid_t) :: old
    integer :: status, i, k, n

    if (size(times) == 0) return
    call h5fopen_f(file%path, H5F_ACC_RDONLY_F, old, status)
    if (status < 0) then
      call raise(error, 'cannot read '//file%path, status_files)
      return
    end if
    do k = 1, size(times)
      do i = 1, size(file%which)
        associate (field => fields(file%which(i)))
          n = merge(model%mesh%n_element, model%mesh%n_node, field%of_cells)
          allocate (rows(n*max(field%n_column, 1)))
          call open_growing(old, 'VTKHDF/'//trim(field%name), field%n_column, array)
          call read_rows(array, (k - 1)*int(n, long), n, c_loc(rows), error)
          call close_growing(array, error)
        end associate
        call append_rows(file%fields(file%which(i)), n, c_loc(rows), error)
        deallocate (rows)
      end do
      call append_instant(file, model, times(k), error)
    end do
    call h5fclose_f(old, status)
    call give_final_name(file, error)
    call mark_broken(file, error)
  end subroutine copy_states

end module results_file_m
