! SPDX-License-Identifier: MIT
!> The results file `<job>.vtkhdf`: states that VTK, ParaView and PyVista read (VTKHDF 2.0,
!> transient unstructured grid), the histories and what is known of the run. The layout is described
!> in doc/results.md; the files of this folder and the reader of the Python tools are the only
!> places that know it.
!>
!> The mesh is stored once; each state appends rows to the arrays. All of a state is handed to the
!> system before the file says that it is there: whenever the process is killed, the file opens with
!> the states before (see results_arrays_m).
module results_file_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, H5F_SCOPE_LOCAL_F, H5_INTEGER_KIND, h5kind_to_type, h5gopen_f, &
    h5gclose_f, h5awrite_f, h5aclose_f, h5fflush_f, h5fclose_f, h5close_f
  use kinds_m, only : wp, long
  use contacts_m, only : has_shear
  use errors_m, only : error_t, raise, status_files
  use files_m, only : file_facts_t, facts_of_name, is_same_file, lengthen_file, remove_file, &
    rename_file, unfinished
  use model_m, only : model_t
  use parts_m, only : has_memory_of_heat
  use snapshot_m, only : snapshot_t
  use history_file_m, only : histories_t
  use results_tables_m, only : run_info_t, write_run, write_histories
  use results_mesh_m, only : write_mesh, deck_nodes
  use results_arrays_m, only : results_file_t, create_file, create_steps, create_fields, &
    planned_states, block_rows, fields, n_step_array, step_values, step_points, step_ones
  use hdf5_writing_m, only : end_of_file, append_rows, close_growing, make_group, &
    write_string_attribute, write_index_attribute, check_status
  implicit none
  private
  public :: results_file_t, run_info_t, open_results, append_state, append_instant, publish, &
    take_name, note_failure, finish_results

contains

  !> Make the file with the mesh and without a state. It has its own name from the first state on,
  !> and `<path>.part` before, so that what stands under the name always opens. A file of that name
  !> from an earlier run is removed, unless its states are going to be taken over.
  subroutine open_results(file, path, model, run_info, goes_on, error)
    type(results_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(model_t), intent(in) :: model
    type(run_info_t), intent(in) :: run_info
    logical, intent(in) :: goes_on      !! a restart: what stands under the name stays for now
    type(error_t), allocatable, intent(out) :: error
    integer(hid_t) :: group
    integer :: status, n_planned, i

    group = -1
    n_planned = planned_states(model%controls)
    file%path = path
    if (.not. goes_on) call remove_file(path, error)
    if (allocated(error)) return
    allocate (file%times(n_planned))
    file%which = pack([(i, i=1, size(fields))], [(has_field(fields(i)%name, model), i=1, &
      size(fields))])
    call create_file(file, error)
    if (allocated(error)) return
    call make_group(file%id, 'VTKHDF', error)
    if (.not. allocated(error)) call h5gopen_f(file%id, 'VTKHDF', group, status)
    call create_steps(file, group, n_planned, error)
    call create_fields(file, group, model%mesh, n_planned, error)
    call write_string_attribute(group, 'Type', 'UnstructuredGrid', .true., error)
    call write_index_attribute(group, 'Version', [2_long, 0_long], error)
    call write_mesh(group, model, error)
    call write_run(file%id, run_info, error)
    call make_group(file%id, 'history', error)
    call publish(file, error)
    call h5gclose_f(group, status)
    allocate (file%rows(3*min(max(model%mesh%n_node, model%mesh%n_element), block_rows)))
    call note_failure(file, error)
  end subroutine open_results

  !> Whether the file of a run has a field.
  pure function has_field(name, model) result(has)
    character(*), intent(in) :: name
    type(model_t), intent(in) :: model
    logical :: has

    select case (name)
    case ('PointData/contact_traction', 'PointData/contact_slip', 'PointData/contact_state')
      has = any(has_shear(model%contacts))
    case ('CellData/hoop_strain')
      has = model%is_round
    case ('CellData/temperature', 'CellData/damage')
      has = any(has_memory_of_heat(model%materials))
    case ('CellData/eroded')
      has = model%erodes
    case default
      has = .true.
    end select
  end function has_field

  !> Append one state and bring it into the file whole.
  subroutine append_state(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in), target :: snapshot
    type(error_t), allocatable, intent(out) :: error

    if (file%id < 0 .or. file%is_broken) return
    call check_untouched(file, error)
    call append_fields(file, model, snapshot, error)
    call append_instant(file, model, snapshot%time, error)
    call take_name(file, error)
    call note_failure(file, error)
  end subroutine append_state

  !> Make a state of the rows that have been appended to the fields.
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

  !> Give the file its own name.
  subroutine take_name(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error) .or. file%is_named) return
    call rename_file(file%path//unfinished, file%path, error)
    file%is_named = .not. allocated(error)
  end subroutine take_name

  !> Append the fields, nodes in deck order; what is missing is zero. Stress is xx yy zz xy yz xz,
  !> of round bodies zz is the hoop stress.
  subroutine append_fields(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in), target :: snapshot
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, first, n, n_row

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
        if (fields(i)%of_cells) then
          call gather_cells(fields(i)%name, first, n, snapshot, file%rows)
        else
          call gather_points(fields(i)%name, deck_nodes(model%mesh, first, n), model, snapshot, &
            file%rows)
        end if
        call append_rows(file%fields(i), n, c_loc(file%rows), error)
      end do
    end do
  end subroutine append_fields

  !> Rows of a field of some nodes.
  pure subroutine gather_points(name, nodes, model, snapshot, rows)
    character(*), intent(in) :: name
    integer, intent(in), contiguous :: nodes(:)
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    real(wp), intent(inout), contiguous :: rows(:)

    select case (name)
    case ('Points')
      call gather_vectors(nodes, snapshot%displacement, rows, model%mesh%coordinates)
    case ('PointData/displacement')
      call gather_vectors(nodes, snapshot%displacement, rows)
    case ('PointData/velocity')
      call gather_vectors(nodes, snapshot%velocity, rows)
    case ('PointData/contact_force')
      call gather_vectors(nodes, snapshot%contact_force, rows)
    case ('PointData/contact_pressure')
      call gather_scalars(nodes, snapshot%contact_pressure, rows)
    case ('PointData/gap')
      call gather_scalars(nodes, snapshot%gap, rows)
    case ('PointData/contact_traction')
      call gather_scalars(nodes, snapshot%contact_traction, rows)
    case ('PointData/contact_slip')
      call gather_scalars(nodes, snapshot%contact_slip, rows)
    case ('PointData/contact_state')
      call gather_scalars(nodes, snapshot%contact_state, rows)
    end select
  end subroutine gather_points

  !> Rows (x, y, 0) of some nodes; the third component stays as it is, and all of them
  !> where there are no vectors.
  pure subroutine gather_vectors(nodes, vectors, rows, origins)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in), allocatable :: vectors(:, :)       !! (2, n_node)
    real(wp), intent(inout) :: rows(3, *)
    real(wp), intent(in), contiguous, optional :: origins(:, :) !! (2, n_node) to be added
    integer :: i

    if (.not. allocated(vectors)) return
    if (present(origins)) then
      do i = 1, size(nodes)
        rows(1:2, i) = origins(:, nodes(i)) + vectors(:, nodes(i))
      end do
    else
      do i = 1, size(nodes)
        rows(1:2, i) = vectors(:, nodes(i))
      end do
    end if
  end subroutine gather_vectors

  !> Values of some nodes; they stay as they are where there are none.
  pure subroutine gather_scalars(nodes, values, rows)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in), allocatable :: values(:) !! (n_node)
    real(wp), intent(inout) :: rows(*)

    if (allocated(values)) rows(:size(nodes)) = values(nodes)
  end subroutine gather_scalars

  !> Rows of a field of `n` elements from the element `first` on.
  pure subroutine gather_cells(name, first, n, snapshot, rows)
    character(*), intent(in) :: name
    integer, intent(in) :: first, n
    type(snapshot_t), intent(in) :: snapshot
    real(wp), intent(inout), contiguous :: rows(:)
    integer :: last

    last = first + n - 1
    associate (stress => snapshot%stress(:, first:last))
      select case (name)
      case ('CellData/plastic_strain')
        if (allocated(snapshot%plastic_strain)) rows(:n) = snapshot%plastic_strain(first:last)
      case ('CellData/pressure')
        rows(:n) = -sum(stress(:3, :), 1)/3.0_wp
      case ('CellData/mises')
        rows(:n) = mises_stress(stress(1, :), stress(2, :), stress(3, :), stress(4, :))
      case ('CellData/hoop_strain')
        rows(:n) = snapshot%hoop_strain(first:last)
      case ('CellData/temperature')
        rows(:n) = snapshot%temperature(first:last)
      case ('CellData/damage')
        rows(:n) = snapshot%damage(first:last)
      case ('CellData/eroded')
        rows(:n) = snapshot%eroded(first:last)
      end select
    end associate
  end subroutine gather_cells

  !> Von Mises stress of a plane-strain state: sqrt(3/2 s:s).
  elemental function mises_stress(xx, yy, zz, xy) result(mises)
    real(wp), intent(in) :: xx, yy, zz, xy   !! Pa
    real(wp) :: mises

    mises = sqrt(0.5_wp*((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3.0_wp*xy**2)
  end function mises_stress

  !> Say how many states the file has, and bring that into the file.
  subroutine publish(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    integer(long), target :: number
    integer :: status

    if (allocated(error)) return
    number = file%n_state
    call h5awrite_f(file%n_steps, h5kind_to_type(long, H5_INTEGER_KIND), c_loc(number), status)
    call check_status(status, 'NSteps', error)
    call flush_file(file, error)
  end subroutine publish

  !> Whether the file still stands under its name as the last flush has left it.
  subroutine check_untouched(file, error)
    type(results_file_t), intent(in) :: file
    type(error_t), allocatable, intent(inout) :: error
    type(file_facts_t) :: now

    if (allocated(error) .or. .not. file%facts%is_there) return
    now = facts_of_name(present_path(file))
    if (.not. is_same_file(now, file%facts)) then
      call raise(error, 'it has been removed or renamed during the run', status_files)
    else if (now%n_byte /= file%facts%n_byte) then
      call raise(error, 'somebody else has changed it during the run', status_files)
    end if
  end subroutine check_untouched

  !> The name that the file has now.
  pure function present_path(file) result(path)
    type(results_file_t), intent(in) :: file
    character(:), allocatable :: path

    path = file%path
    if (.not. file%is_named) path = path//unfinished
  end function present_path

  !> Hand all that waits to the system. HDF5 writes how long the file is before it makes it so long:
  !> where that is refused (a largest file size) the states before could not be read any more.
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

  !> After a failure: put the file's name before the message, and leave the file as the last flush
  !> left it, with the states before. Closing it would make HDF5 try again, and crash.
  subroutine note_failure(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(error)) return
    error%message = file%path//': '//error%message
    file%is_broken = .true.
  end subroutine note_failure

  !> Write the histories and close the file; nothing happens when it is not open or a write has
  !> failed.
  subroutine finish_results(file, histories, error)
    type(results_file_t), intent(inout) :: file
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(out) :: error
    integer :: i, status

    if (file%id < 0 .or. file%is_broken) return
    call check_untouched(file, error)
    call write_histories(file%id, histories, error)
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
    call take_name(file, error)
    call note_failure(file, error)
  end subroutine finish_results

end module results_file_m
