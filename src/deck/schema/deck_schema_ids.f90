! SPDX-License-Identifier: MIT
!> Fields that hold numbers of entities, by the kinds of offsets of *INCLUDE_TRANSFORM.
module deck_schema_ids_m
  use deck_schema_m, only : text_of_field
  implicit none
  private
  public :: offset_kind, n_offset, offset_node, offset_element, offset_part, offset_material, &
    offset_set, offset_curve, offset_define, offset_other, offset_by_option

  !> Kinds of offsets, in the order of IDNOFF to IDDOFF and IDROFF; `offset_by_option`: the kind is
  !> that of the option in the first field, or of STYP.
  integer, parameter :: n_offset = 8, offset_node = 1, offset_element = 2, offset_part = 3, &
    offset_material = 4, offset_set = 5, offset_curve = 6, offset_define = 7, offset_other = 8, &
    offset_by_option = 9

  !> Fields without their digits, or beginnings of keywords and such fields, and the kind of their
  !> offset; the first match counts.
  character(90), parameter :: id_fields(*) = [character(90) :: &
    'SET_NODE_GENERAL.E,SET_SEGMENT_GENERAL.E,INITIAL_VELOCITY_GENERATION.ID 9', &
    'DATABASE_HISTORY_NODE_SET.ID,DATABASE_HISTORY_SHELL_SET.ID 5', &
    'DATABASE_HISTORY_NODE.ID,SET_NODE_LIST_GENERATE.BBEG,SET_NODE_LIST_GENERATE.BEND 1', &
    'DATABASE_HISTORY_SHELL.ID,SET_SHELL_LIST_GENERATE.BBEG,SET_SHELL_LIST_GENERATE.BEND 2', &
    'SET_PART_LIST_GENERATE.BBEG,SET_PART_LIST_GENERATE.BEND 3', &
    'CONTROL_SOLUTION.LCINT,DEFINE_CURVE.LCINT 0', &
    'TERMINATION_CONTACT.CID,SECID,HGID 8', &
    'NID,N,NODEID 1', &
    'EID 2', &
    'PID 3', &
    'MID,EOSID 4', &
    'SID,NSID,NSIDEX,PSID,SSID,SURFA,SURFB 5', &
    'LCID,LCSS,LCSR,LCTM,LCUR,LCDT,LCINT,TBID 6', &
    'CID,BOXID,TRANID 7']

contains

  !> Kind of the offset of an integer field, 0 where it holds no number of an entity.
  pure function offset_kind(keyword, field) result(kind)
    character(*), intent(in) :: keyword, field
    integer :: kind
    character(:), allocatable :: stem, text
    integer :: i

    stem = ''
    do i = 1, len_trim(field)
      if (scan(field(i:i), '0123456789') == 0) stem = stem//field(i:i)
    end do
    text = text_of_field(id_fields, keyword, stem)
    kind = 0
    if (len(text) > 0) kind = index('123456789', text)
  end function offset_kind

end module deck_schema_ids_m
