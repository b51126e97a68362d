! SPDX-License-Identifier: MIT
!> Tangent of type 4 (doc/theory/contact.md, section 9.3).
module tangent_vts_ppt_m
  use behind_ties_m, only : is_left_to_tie
  use assembly_m, only : add_varied_point, pattern_t, start_pattern, add_to_row, &
    add_to_column, add_product
  use contact_law_m, only : vary_pressure
  use contact_state_m, only : contact_state_t
  use variation_m, only : varied_point_t, varied_foot_t, round_off, apart, length_between, &
    project, see_from, spot_foot, vary_radius, vary_centroid
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use foot_m, only : mark_t, walk_to_mark
  use friction_tangent_m, only : vary_slip, largest_grip, state_before
  use kinds_m, only : wp
  use law_friction_m, only : vary_traction
  use place_vts_ppt_m, only : end_of_half
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_vts_ppt_tangent

contains

  !> All virtual nodes in contact.
  pure subroutine add_vts_ppt_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(pattern_t) :: pattern
    type(varied_point_t), allocatable :: portions(:)
    integer :: k, spot

    call start_pattern(pattern, size(equations, 2))
    do k = 1, memory%slave_tracking%n_touching
      spot = memory%slave_tracking%touching(k)
      if (.not. memory%slave_tracking%gap(spot) + left_at(contact, memory, spot) &
        < memory%closed_gap) cycle
      if (is_left_to_tie(memory, place_of_spot(contact, spot))) cycle
      call vary_portions(contact, memory, spot, portions)
      call add_portions(contact, spot, portions, memory, pattern, equations, matrix)
    end do
  end subroutine add_vts_ppt_tangent

  !> The place of a virtual node in what friction and ties remember.
  pure function place_of_spot(contact, spot) result(place)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: spot
    integer :: place

    place = 2*contact%slave%segments(1, (spot + 1)/2) - mod(spot, 2)
  end function place_of_spot

  !> The portions of a virtual node, each with its own length on the master as area.
  pure subroutine vary_portions(contact, memory, spot, portions)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), allocatable, intent(out) :: portions(:)
    type(varied_point_t) :: point
    type(mark_t) :: marks(2)
    type(dual_t) :: range(2)
    integer :: segment, n, k
    logical :: is_first, is_last

    call start_point(contact, memory, spot, point)
    do k = 1, 2
      associate (xi => end_of_half(memory%spot_xi(2 - mod(spot, 2)), k))
        marks(k) = walk_to_mark(contact%master, memory%places(:, memory%n_slave + 1:), &
          (1.0_wp - xi)*memory%places(:, point%nodes(1)) + xi*memory%places(:, point%nodes(2)), &
          memory%slave_tracking%segment(spot))
      end associate
    end do
    allocate (portions(1 + max(0, marks(2)%n_step - marks(1)%n_step)))
    n = 0
    segment = marks(1)%segment
    do k = 0, marks(2)%n_step - marks(1)%n_step
      is_first = k == 0
      is_last = segment == marks(2)%segment
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, segment)
      range = constant([0.0_wp, 1.0_wp])
      if (is_first) range(1) = vary_mark(memory, spot, point, 1, marks(1))
      if (is_last) range(2) = vary_mark(memory, spot, point, 2, marks(2))
      segment = contact%master%next(segment)
      if (.not. range(2)%value > range(1)%value) cycle
      n = n + 1
      portions(n) = point
      call set_range(contact, memory, range, portions(n))
    end do
    if (n == 0) then
      n = 1
      call set_whole(contact, memory, spot, point)
      portions(1) = point
    end if
    portions = portions(:n)
  end subroutine vary_portions

  !> What all portions of a virtual node share: its segment in slots 1, 2, its master segment in
  !> slots 5, 6, gap and normal.
  pure subroutine start_point(contact, memory, spot, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), intent(out) :: point
    type(varied_foot_t) :: foot

    associate (tracking => memory%slave_tracking)
      point%nodes(1:2) = contact%slave%segments(:, (spot + 1)/2)
      point%nodes(5:6) = memory%n_slave + contact%master%segments(:, tracking%segment(spot))
      point%slave_xi = constant(memory%spot_xi(2 - mod(spot, 2)))
      if (contact%is_round) point%slave_xi = vary_centroid(memory%places, point%nodes, 1, 2, &
        constant(end_of_half(point%slave_xi%value, 2)), &
        constant(end_of_half(point%slave_xi%value, 1)))
      foot = spot_foot(memory%places, point, 5, tracking%xi(spot), tracking%gap(spot), &
        memory%closed_gap)
    end associate
    point%gap = foot%gap
    point%normal = foot%normal
    point%master_xi = foot%xi
  end subroutine start_point

  !> The k-th mark on the segment in slots 3, 4; constant where it has been stopped at a node.
  pure function vary_mark(memory, spot, point, k, mark) result(xi)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: k
    type(mark_t), intent(in) :: mark
    type(dual_t) :: xi
    type(varied_point_t) :: place
    type(varied_foot_t) :: foot

    place = point
    place%slave_xi = constant(end_of_half(memory%spot_xi(2 - mod(spot, 2)), k))
    foot = project(see_from(memory%places, place, 3), apart(memory%places, place%nodes, 4, 3))
    xi = foot%xi
    if (.not. mark%xi < 0.0_wp .and. xi%value < -round_off) xi = constant(0.0_wp)
    if (.not. mark%xi > 1.0_wp .and. xi%value > 1.0_wp + round_off) xi = constant(1.0_wp)
  end function vary_mark

  !> Let the portion be this range of the segment in slots 3, 4.
  pure subroutine set_range(contact, memory, range, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: range(2)
    type(varied_point_t), intent(inout) :: point

    point%master_xi = 0.5_wp*(range(1) + range(2))
    point%area = (range(2) - range(1))*length_between(memory%places, point%nodes, 3, 4)
    if (.not. contact%is_round) return
    point%area = point%area*vary_radius(memory%places, point%nodes, 3, 4, point%master_xi)
    point%master_xi = vary_centroid(memory%places, point%nodes, 3, 4, range(1), range(2))
  end subroutine set_range

  !> A virtual node without portions: all goes to its own foot.
  pure subroutine set_whole(contact, memory, spot, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), intent(inout) :: point
    type(varied_foot_t) :: foot

    associate (tracking => memory%slave_tracking)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, tracking%segment(spot))
      foot = spot_foot(memory%places, point, 3, tracking%xi(spot), tracking%gap(spot), &
        memory%closed_gap)
    end associate
    point%master_xi = foot%xi
    point%area = length_between(memory%places, point%nodes, 3, 4)
  end subroutine set_whole

  !> Share out half of the slave segment by the portions' lengths: each share at a constant sum of
  !> these, and the change of the sum as one product of two vectors.
  pure subroutine add_portions(contact, spot, portions, memory, pattern, equations, matrix)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: spot
    type(varied_point_t), intent(in) :: portions(:)
    type(contact_state_t), intent(in) :: memory
    type(pattern_t), intent(inout) :: pattern
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: half, pressure, grip, load, shear
    real(wp) :: total
    integer :: k

    total = sum(portions%area%value)
    half = 0.5_wp*length_between(memory%places, portions(1)%nodes, 1, 2)
    if (contact%is_round) half = half*vary_radius(memory%places, portions(1)%nodes, 1, 2, &
      constant(memory%spot_xi(2 - mod(spot, 2))))
    pressure = vary_pressure(memory%contact_law, memory%slave_penalty, portions(1)%gap &
      + left_at(contact, memory, spot))
    if (memory%has%friction) grip = vary_grip(contact, memory, spot, portions(1), &
      pressure)
    do k = 1, size(portions)
      load = (1.0_wp/total)*(pressure*half*portions(k)%area)
      call add_to_row(pattern, portions(k), portions(k)%area%slope)
      if (memory%has%friction) then
        shear = (1.0_wp/total)*(grip*half*portions(k)%area)
        call add_varied_point(portions(k), load, equations, matrix, shear)
        call add_to_column(pattern, portions(k), load%value, shear%value)
      else
        call add_varied_point(portions(k), load, equations, matrix)
        call add_to_column(pattern, portions(k), load%value, 0.0_wp)
      end if
    end do
    call add_product(pattern, 1.0_wp/total, equations, matrix)
  end subroutine add_portions

  !> The part of its depth that does not act: entry offset, and what is left of an initial overlap.
  pure function left_at(contact, memory, spot) result(left)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    real(wp) :: left

    left = memory%slave_tracking%offset(spot)
    if (.not. memory%has%interference) return
    left = left + memory%interference%left*memory%interference%depth(2*contact%slave%segments(1, &
      1 + (spot - 1)/2) - mod(spot, 2))
  end function left_at

  !> Traction of a virtual node, which slips at its own foot.
  pure function vary_grip(contact, memory, spot, point, pressure) result(traction)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), intent(in) :: point !! one of its portions
    type(dual_t), intent(in) :: pressure
    type(dual_t) :: traction
    type(varied_foot_t) :: foot
    integer :: place

    place = 2*point%nodes(1) - mod(spot, 2)
    associate (tracking => memory%slave_tracking)
      foot = spot_foot(memory%places, point, 5, tracking%xi(spot), tracking%gap(spot), &
        memory%closed_gap)
    end associate
    traction = vary_traction(contact%friction, &
      constant(memory%scratch%former_traction(place)), vary_slip(memory, point, 5, foot%xi), &
      pressure, contact%friction%stiffness*memory%slave_penalty, &
      largest_grip(contact%friction), [memory%scratch%dt, memory%scratch%lag], &
      state_before(memory, place))
  end function vary_grip

end module tangent_vts_ppt_m
