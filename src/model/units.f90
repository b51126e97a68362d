! SPDX-License-Identifier: MIT
!> Names of the units of a deck in messages, from *CONTROL_UNITS; none without it. Numbers are not
!> converted.
module units_m
  use kinds_m, only : wp
  implicit none
  private
  public :: units_t, find_unit, set_force, in_units, per_depth

  !> Names of the units; blank where the deck does not give them.
  type :: units_t
    character(8) :: names(3) = '' !! of length, time and mass
    character(16) :: force = ''
  end type units_t

  !> One unit of *CONTROL_UNITS.
  type :: unit_t
    integer :: quantity       !! 1 length, 2 time, 3 mass
    character(8) :: word      !! in the deck, upper case
    character(8) :: name      !! in messages
    real(wp) :: value         !! in m, s or kg
  end type unit_t

  type(unit_t), parameter :: known(*) = [ &
    unit_t(1, 'M', 'm', 1.0_wp), unit_t(1, 'CM', 'cm', 1.0e-2_wp), &
    unit_t(1, 'MM', 'mm', 1.0e-3_wp), unit_t(1, 'IN', 'in', 0.0254_wp), &
    unit_t(1, 'FT', 'ft', 0.3048_wp), &
    unit_t(2, 'SEC', 's', 1.0_wp), unit_t(2, 'S', 's', 1.0_wp), &
    unit_t(2, 'MS', 'ms', 1.0e-3_wp), unit_t(2, 'MSEC', 'ms', 1.0e-3_wp), &
    unit_t(2, 'MICRO_S', 'us', 1.0e-6_wp), unit_t(2, 'MICROSEC', 'us', 1.0e-6_wp), &
    unit_t(3, 'KG', 'kg', 1.0_wp), unit_t(3, 'G', 'g', 1.0e-3_wp), &
    unit_t(3, 'MG', 'mg', 1.0e-6_wp), unit_t(3, 'MTRC_TON', 't', 1.0e3_wp), &
    unit_t(3, 'LB', 'lb', 0.45359237_wp), unit_t(3, 'SLUG', 'slug', 14.5939029372_wp), &
    unit_t(3, 'SLINCH', 'slinch', 175.126835246_wp)]

  !> Names of force units, and their values in N.
  character(3), parameter :: force_names(*) = ['N  ', 'kN ', 'MN ', 'mN ', 'lbf']
  real(wp), parameter :: forces(*) = [1.0_wp, 1.0e3_wp, 1.0e6_wp, 1.0e-3_wp, 4.4482216_wp]

contains

  !> Name and value of a unit of *CONTROL_UNITS; the name is blank where the word is unknown.
  pure subroutine find_unit(quantity, word, name, value)
    integer, intent(in) :: quantity         !! 1 length, 2 time, 3 mass
    character(*), intent(in) :: word        !! upper case
    character(*), intent(out) :: name
    real(wp), intent(out) :: value          !! in m, s or kg
    integer :: i

    name = ''
    value = 0.0_wp
    do i = 1, size(known)
      if (known(i)%quantity /= quantity .or. known(i)%word /= word) cycle
      name = known(i)%name
      value = known(i)%value
    end do
  end subroutine find_unit

  !> Set the unit of force from length, time and mass.
  pure subroutine set_force(values, units)
    real(wp), intent(in) :: values(3) !! units in m, s and kg
    type(units_t), intent(inout) :: units
    real(wp), parameter :: close = 1.0e-6_wp
    real(wp) :: force
    integer :: i

    units%force = '('//trim(units%names(3))//' '//trim(units%names(1))//'/' &
      //trim(units%names(2))//'^2)'
    force = values(3)*values(1)/values(2)**2
    do i = 1, size(forces)
      if (abs(force - forces(i)) <= close*forces(i)) units%force = force_names(i)
    end do
  end subroutine set_force

  !> A blank and the name of a unit, from F, L and T for force, length and time: ' N/mm^2' for
  !> 'F/L^2'; empty where the deck does not give its units.
  pure function in_units(units, form) result(text)
    type(units_t), intent(in) :: units
    character(*), intent(in) :: form
    character(:), allocatable :: text
    integer :: k

    text = ''
    if (len_trim(units%force) == 0) return
    text = ' '
    do k = 1, len(form)
      select case (form(k:k))
      case ('F')
        text = text//trim(units%force)
      case ('L')
        text = text//trim(units%names(1))
      case ('T')
        text = text//trim(units%names(2))
      case default
        text = text//form(k:k)
      end select
    end do
  end function in_units

  !> As `in_units`, per unit depth of plane strain and per radian of axisymmetric bodies.
  pure function per_depth(units, form, is_axisymmetric, is_sheet) result(text)
    type(units_t), intent(in) :: units
    character(*), intent(in) :: form
    logical, intent(in) :: is_axisymmetric, is_sheet
    character(:), allocatable :: text

    if (is_axisymmetric) then
      text = in_units(units, form)//' per radian'
    else
      text = in_units(units, form//trim(merge('  ', '/L', is_sheet)))
    end if
  end function per_depth

end module units_m
