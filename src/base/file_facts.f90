! SPDX-License-Identifier: MIT
!> What the system knows of a file: kind, identity and length. By `statx` of Linux, whose answer is
!> laid out alike on all processors.
module file_facts_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_int16_t, c_int32_t, c_int64_t, &
    c_null_char
  use kinds_m, only : long
  implicit none
  private
  public :: file_facts_t, facts_of_name, facts_of_target, facts_of_descriptor, what_hinders, &
    is_same_file

  !> What is known of a file.
  type :: file_facts_t
    logical :: is_there = .false.
    logical :: is_regular = .false.
    integer :: kind = 0            !! bits of the kind, as in st_mode
    integer(long) :: device = 0    !! of the file system
    integer(long) :: identity = 0  !! inode, of its own within a device
    integer(long) :: n_name = 0    !! hard links; 0: removed while open
    integer(long) :: n_byte = 0    !! length
  end type file_facts_t

  !> Answer of the system (struct statx).
  type, bind(c) :: statx_t
    integer(c_int32_t) :: mask = 0, block_size = 0
    integer(c_int64_t) :: attributes = 0
    integer(c_int32_t) :: n_link = 0, user = 0, group = 0
    integer(c_int16_t) :: mode = 0, spare_1 = 0
    integer(c_int64_t) :: inode = 0, size = 0
    integer(c_int64_t) :: skipped(11) = 0, device = 0, spare(14) = 0
  end type statx_t

  !> Of the system: names from the present directory; links are followed or not; the open file
  !> itself; what is asked for (kind, links, inode, length).
  integer(c_int), parameter :: present_directory = -100, follow = 0, no_follow = 256, &
    open_file = 4096, wanted = ior(ior(1, 4), ior(256, 512))
  !> Kinds (S_IFMT and so on).
  integer, parameter :: kind_bits = 61440, kind_pipe = 4096, kind_directory = 16384, &
    kind_regular = 32768, kind_link = 40960, kind_socket = 49152

  interface
    !> Linux statx; 0 on success.
    function c_statx(directory, path, flags, mask, answer) bind(c, name='statx') result(status)
      import :: c_char, c_int, statx_t
      integer(c_int), value :: directory            !! or the open file itself
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      integer(c_int), value :: flags, mask
      type(statx_t), intent(inout) :: answer
      integer(c_int) :: status
    end function c_statx
  end interface

contains

  !> Facts of what stands under a name; of a symbolic link they are the link's own.
  function facts_of_name(path) result(facts)
    character(*), intent(in) :: path
    type(file_facts_t) :: facts

    facts = ask_system(present_directory, path, no_follow)
  end function facts_of_name

  !> Facts of the file that a name leads to, over links too.
  function facts_of_target(path) result(facts)
    character(*), intent(in) :: path
    type(file_facts_t) :: facts

    facts = ask_system(present_directory, path, follow)
  end function facts_of_target

  !> Facts of an open file.
  function facts_of_descriptor(descriptor) result(facts)
    integer(c_int), intent(in) :: descriptor
    type(file_facts_t) :: facts

    facts = ask_system(descriptor, '', open_file)
  end function facts_of_descriptor

  !> Ask the system. Where it gives no answer there is nothing.
  function ask_system(directory, path, flags) result(facts)
    integer(c_int), intent(in) :: directory, flags
    character(*), intent(in) :: path
    type(file_facts_t) :: facts
    type(statx_t) :: answer

    facts%is_there = c_statx(directory, path//c_null_char, flags, wanted, answer) == 0
    if (.not. facts%is_there) return
    facts%kind = iand(int(answer%mode), kind_bits)
    facts%is_regular = facts%kind == kind_regular
    facts%device = int(answer%device, long)
    facts%identity = int(answer%inode, long)
    facts%n_name = int(answer%n_link, long)
    facts%n_byte = int(answer%size, long)
  end function ask_system

  !> What under a name is in the way of a file to be written, in words; empty when nothing is: a
  !> name that is free or that of a regular file.
  function what_hinders(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason
    type(file_facts_t) :: facts

    reason = ''
    facts = facts_of_name(path)
    if (.not. facts%is_there .or. facts%is_regular) return
    select case (facts%kind)
    case (kind_directory); reason = 'it is a directory'
    case (kind_link); reason = 'it is a symbolic link, and results are neither written through ' &
      //'links nor put in their place'
    case (kind_pipe); reason = 'it is a pipe'
    case (kind_socket); reason = 'it is a socket'
    case default; reason = 'it is a device'
    end select
  end function what_hinders

  !> Whether two facts are of one file.
  pure function is_same_file(a, b) result(same)
    type(file_facts_t), intent(in) :: a, b
    logical :: same

    same = a%is_there .and. b%is_there .and. a%identity == b%identity .and. &
      a%device == b%device
  end function is_same_file

end module file_facts_m
