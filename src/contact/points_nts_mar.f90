! SPDX-License-Identifier: MIT
!> Type 5, NTS-mAR: type 2 with a modified competence length, and in addition the master nodes
!> between the feet of the two ends of a slave segment, projected on that segment
!> (doc/theory/contact.md, section 5.5).
module points_nts_mar_m
  use contact_admission_m, only : all_asleep, is_asleep, judge_segment, note_next_wake
  use contact_competence_m, only : competence_length
  use contact_cuts_m, only : share_cuts
  use contact_keeping_m, only : take_foot
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece, &
    see_master_node, facing_share
  use contact_plain_cover_m, only : plain_cover_t, clear_list, list_pointed, list_segment, &
    list_other, cut_segments
  use contact_placing_m, only : add_touching_nodes, put_stiffness, forget_other_stiffness
  use contact_projection_m, only : see_segment
  use contact_state_m, only : contact_points_t, contact_state_t, make_room, n_side
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_gap, sight_normal
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: place_nts_mar, is_tip

contains

  !> Place the points: slave nodes first; then, segment by segment, their areas and the master
  !> nodes.
  pure subroutine place_nts_mar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t) :: cover
    integer :: s, n
    logical :: is_known

    if (all_asleep(memory)) return
    call add_touching_nodes(memory%slave_tracking, contact%master, 0, memory%n_slave, &
      memory%points, is_known)
    n = memory%points%n
    if (.not. is_known) call mark_points(n, memory%points%slave_nodes, memory%mark)
    memory%points%area(:n) = 0.0_wp
    if (.not. is_known) memory%points%n_former = 0
    call forget_other_stiffness(memory%slave_penalty, memory%points)
    call put_stiffness(memory%slave_penalty, is_known, memory%points)
    call clear_list(cover)
    s = 1
    do while (s <= contact%slave%n_segment)
      call list_pointed(contact, memory, s, cover)
      if (.not. cover%is_full) call take_segment(contact, memory, s, cover)
      if (cover%is_full) call share_list(contact, memory, cover)
    end do
    call share_list(contact, memory, cover)
    call note_next_wake(memory)
    call finish_nodes(contact, memory, n)
  end subroutine place_nts_mar

  !> Put the next segment from s on that may touch on the list: s is then the one behind it.
  pure subroutine take_segment(contact, memory, s, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(inout) :: s
    type(plain_cover_t), intent(inout) :: cover
    logical :: is_listed

    do while (s <= contact%slave%n_segment)
      s = s + 1
      if (is_asleep(memory, s - 1, contact%slave%segments(:, s - 1))) cycle
      call take_feet_of(contact%slave%segments(:, s - 1), memory)
      call list_segment(contact, memory, s - 1, .false., cover, is_listed)
      if (.not. is_listed) call list_other(s - 1, cover)
      return
    end do
  end subroutine take_segment

  !> Take the feet of some slave nodes to the tracking, where those of the nodes in contact are on
  !> the points only.
  pure subroutine take_feet_of(nodes, memory)
    integer, intent(in) :: nodes(2)
    type(contact_state_t), intent(inout) :: memory
    integer :: k

    if (memory%slave_tracking%has_feet) return
    do k = 1, 2
      if (memory%mark(nodes(k)) > 0) &
        call take_foot(memory%points, memory%mark(nodes(k)), nodes(k), memory%slave_tracking)
    end do
  end subroutine take_feet_of

  !> Remember which point stands at which slave node, until other nodes touch.
  pure subroutine mark_points(n, nodes, mark)
    integer, intent(in) :: n, nodes(n_side, *)
    integer, intent(inout), contiguous :: mark(:)
    integer :: k

    mark = 0
    do k = 1, n
      mark(nodes(1, k)) = k
    end do
  end subroutine mark_points

  !> Nodes at a tip keep their whole competence length. Their feet are in the tracking since their
  !> segments were shared.
  pure subroutine finish_nodes(contact, memory, n)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: n !! points at slave nodes
    integer :: p, node

    if (count(memory%points%area(:n) > 0.0_wp) == n) return
    do p = 1, n
      if (memory%points%area(p) > 0.0_wp) cycle
      node = memory%points%slave_nodes(1, p)
      if (is_tip(contact%slave, memory, node)) memory%points%area(p) = competence_length( &
        contact%slave, memory%places(:, :memory%n_slave), node)
    end do
  end subroutine finish_nodes

  !> Whether none of the segments at a touching slave node faces the master at its foot.
  pure function is_tip(slave, memory, node)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node
    logical :: is_tip
    integer :: k, s
    type(sight_t) :: sight

    is_tip = .true.
    do k = 1, 2
      s = merge(slave%incoming(node), slave%outgoing(node), k == 1)
      if (s == 0) cycle
      sight = see_segment(slave, memory%places(:, :memory%n_slave), memory%places(:, node), s)
      if (facing_share(dot_product(sight_normal(sight), memory%slave_tracking%normal(:, node))) &
        > 0.0_wp) is_tip = .false.
    end do
  end function is_tip

  !> Divide the segments on a list, and clear it.
  pure subroutine share_list(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(inout) :: cover
    integer :: i, first

    call cut_segments(contact, memory, cover)
    first = 1
    do i = 1, cover%n_segment
      if (cover%is_plain(i)) cycle
      call share_cuts(contact, memory, cover, first, i - 1)
      call share_segment(contact, memory, cover%slave(i))
      first = i + 1
    end do
    call share_cuts(contact, memory, cover, first, cover%n_segment)
    call clear_list(cover)
  end subroutine share_list

  !> Divide a slave segment among its ends and the master nodes between their feet: half of each
  !> piece to either of its ends. The strict rule adds no node where an end of the segment has no
  !> foot; otherwise the part beyond the last master node carries nothing, nor do pieces that do not
  !> face the master.
  pure subroutine share_segment(contact, memory, s)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    type(cover_t) :: cover
    type(piece_t) :: piece
    type(sight_t) :: sight
    real(wp) :: length, half, before, deepest
    logical :: counts
    integer :: n_before, node_before

    n_before = memory%points%n
    call take_feet_of(contact%slave%segments(:, s), memory)
    call find_cover(contact, memory, s, cover)
    sight = sight_of_segment(memory%places(:, cover%ends(2)), memory%places(:, cover%ends(1)), &
      memory%places(:, cover%ends(2)))
    length = sqrt(sight%square)
    call first_piece(contact, memory, cover, piece)
    if (contact%strict .and. (piece%is_last .or. .not. all(cover%feet%is_on))) then
      call add_area(memory, cover%ends(1), 0.5_wp*length)
      call add_area(memory, cover%ends(2), 0.5_wp*length)
      piece%is_last = .true.
    end if
    before = 0.0_wp
    node_before = 0
    do while (.not. piece%is_last)
      call next_piece(contact, memory, cover, piece)
      if (.not. piece%high > piece%low) cycle
      if (before > 0.0_wp .and. piece%low_node /= node_before) then
        ! Between two chains of the master.
        call add_master_node(memory, cover, node_before, before)
        before = 0.0_wp
      end if
      half = 0.5_wp*(piece%high - piece%low)*length
      if (.not. contact%strict) half = half*piece%share
      if (piece%low_node > 0) then
        if (before + half > 0.0_wp) &
          call add_master_node(memory, cover, piece%low_node, before + half)
      else
        call add_area(memory, cover%ends(1), half)
      end if
      before = half
      node_before = piece%high_node
    end do
    if (before > 0.0_wp .and. node_before > 0) then
      call add_master_node(memory, cover, node_before, before)
    else
      call add_area(memory, cover%ends(2), before)
    end if
    deepest = minval(memory%points%gap(n_before + 1:memory%points%n))
    call judge_segment(contact, memory, s, cover%ends, deepest, counts)
    if (.not. counts) memory%points%n = n_before
  end subroutine share_segment

  !> Give length to the point at a slave node, where there is one.
  pure subroutine add_area(memory, node, length)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: node
    real(wp), intent(in) :: length
    integer :: p

    p = memory%mark(node)
    if (p > 0) memory%points%area(p) = memory%points%area(p) + length
  end subroutine add_area

  !> A point at a master node behind the slave segment, with the normal of that segment.
  pure subroutine add_master_node(memory, cover, node, area)
    type(contact_state_t), intent(inout) :: memory
    type(cover_t), intent(in) :: cover
    integer, intent(in) :: node
    real(wp), intent(in) :: area
    type(sight_t) :: sight

    sight = see_master_node(memory, cover, node)
    if (sight%across >= 0.0_wp .and. sight_gap(sight) >= memory%closed_gap) return
    call add_cut(memory, cover%ends, node, sight%along/sight%square, sight_gap(sight), &
      -sight_normal(sight), area)
  end subroutine add_master_node

  !> Append a point at a master node.
  pure subroutine add_cut(memory, ends, node, xi, gap, normal, area)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)       !! nodes of the slave segment
    integer, intent(in) :: node          !! of the master
    real(wp), intent(in) :: xi           !! where it is on the segment
    real(wp), intent(in) :: gap          !! m
    real(wp), intent(in) :: normal(2)    !! against the segment's own
    real(wp), intent(in) :: area         !! m

    if (memory%points%n + 1 > size(memory%points%gap)) call make_room(memory%points, 1)
    associate (points => memory%points, p => memory%points%n)
      p = p + 1
      points%slave_nodes(1, p) = ends(1)
      points%slave_nodes(2, p) = ends(2)
      points%slave_weights(1, p) = 1.0_wp - xi
      points%slave_weights(2, p) = xi
      points%master_nodes(1, p) = memory%n_slave + node
      points%master_nodes(2, p) = memory%n_slave + node
      points%master_weights(1, p) = 1.0_wp
      points%master_weights(2, p) = 0.0_wp
      points%normal(1, p) = normal(1)
      points%normal(2, p) = normal(2)
      points%gap(p) = gap
      points%area(p) = area
      points%stiffness(p) = memory%slave_penalty
    end associate
  end subroutine add_cut

end module points_nts_mar_m
