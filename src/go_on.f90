! SPDX-License-Identifier: MIT
!> The deck of a run that goes on from a restart file: that of the file, with what the command
!> line and a small deck change.
module go_on_m
  use arguments_m, only : arguments_t, only_end_time
  use contact_dispatch_m, only : contact_kinds
  use deck_m, only : deck_request_t, read_deck
  use deck_restart_m, only : merge_decks, is_whole_deck, deck_identity
  use deck_reader_m, only : read_file
  use errors_m, only : error_t, raise, status_input
  use log_m, only : log_t, write_log
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use restart_reading_m, only : take_up_file
  implicit none
  private
  public :: take_up_deck

contains

  !> Open the restart file and ask for its deck.
  subroutine take_up_deck(arguments, program, monitor, request, error)
    type(arguments_t), intent(inout) :: arguments  !! gets the job name of the file
    character(*), intent(in) :: program            !! version and build of this program
    type(monitor_t), intent(inout) :: monitor
    type(deck_request_t), intent(inout) :: request
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: deck, changes, reason

    call take_up_file(arguments%restart, monitor%restarts, deck, error)
    if (allocated(error)) return
    call write_log(monitor%log, 'goes on from the restart file '//arguments%restart)
    if (monitor%restarts%program /= program) call write_log(monitor%log, 'the restart file was ' &
      //'written by another build ('//monitor%restarts%program//'): the last bits may differ')
    if (.not. allocated(arguments%job)) arguments%job = monitor%restarts%job
    request%path = arguments%restart
    if (allocated(arguments%deck)) then
      allocate (character(len(arguments%deck)) :: request%files(1))
      request%files = arguments%deck
      call read_file(arguments%deck, changes, reason)
      if (allocated(reason)) then
        call raise(error, 'cannot read the deck '//arguments%deck//': '//reason, status_input)
        return
      end if
      if (is_whole_deck(changes)) then
        call take_whole_deck(arguments, deck, monitor%restarts%is_implicit, request, error)
        return
      end if
      call merge_decks(deck, changes, arguments%deck, request%text, error)
      if (allocated(error)) return
    else
      allocate (character(1) :: request%files(0))
      call move_alloc(deck, request%text)
    end if
    if (.not. only_end_time(arguments)) call raise(error, &
      'when a run goes on the command line may change its end time alone (endtim=)', &
      status_input)
  end subroutine take_up_deck

  !> A whole deck beside the restart file must be that of the file but for what may change.
  subroutine take_whole_deck(arguments, deck, is_implicit, request, error)
    type(arguments_t), intent(in) :: arguments
    character(*), intent(in) :: deck               !! that of the file
    logical, intent(in) :: is_implicit             !! method of the run that wrote it
    type(deck_request_t), intent(inout) :: request
    type(error_t), allocatable, intent(out) :: error
    type(deck_request_t) :: whole
    type(log_t) :: unused
    type(model_t) :: model

    whole%path = arguments%deck
    whole%overrides = arguments%overrides
    call read_deck(whole, contact_kinds, unused, model, request%text, error)
    if (allocated(whole%files)) call move_alloc(whole%files, request%files)
    if (allocated(error)) return
    if (model%controls%implicit%is_on .neqv. is_implicit) then
      call raise(error, 'the restart file '//arguments%restart//' is refused: it is of ' &
        //trim(merge('an implicit run', 'an explicit run', is_implicit))//', and '//arguments%deck &
        //' asks for the '//trim(merge('explicit', 'implicit', is_implicit))//' method', &
        status_input)
    else if (deck_identity(request%text) == deck_identity(deck)) then
      deallocate (request%overrides) ! they are in the text
    else
      call raise(error, 'the restart file '//arguments%restart &
        //' is refused: it belongs to another deck (checksum '//deck_identity(deck)//') than ' &
        //arguments%deck//' ('//deck_identity(request%text)//')', status_input)
    end if
  end subroutine take_whole_deck

end module go_on_m
