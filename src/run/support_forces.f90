! SPDX-License-Identifier: MIT
!> Forces by which constraints hold fixed nodes (spcforc). Where a degree of freedom is fixed,
!> R = m a + f with a = 0 and f the internal less all other forces.
module support_forces_m
  use history_tables_m, only : table_spcforc
  use kinds_m, only : wp, long
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use sorting_m, only : sorted_order
  use state_m, only : state_t
  use supports_m, only : mark_supports
  implicit none
  private
  public :: find_supports, fill_reactions, fill_explicit_reactions

contains

  !> Nodes with mass and a fixed degree of freedom by rising id; none where the deck does
  !> not ask for their forces.
  subroutine find_supports(model, snapshot)
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    allocate (snapshot%supports(0))
    associate (interval => model%controls%output%histories(table_spcforc))
      if (interval%dt > 0.0_wp .or. interval%curve > 0) &
        snapshot%supports = pack([(i, i=1, model%mesh%n_node)], mark_supports(model))
    end associate
    snapshot%supports = snapshot%supports(sorted_order(int(model%mesh%node_id(snapshot%supports), &
      long)))
    allocate (snapshot%reaction(2, size(snapshot%supports)), source=0.0_wp)
  end subroutine find_supports

  !> Reactions from R of all degrees of freedom; 0 in directions that are free.
  pure subroutine fill_reactions(model, reaction, snapshot)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node)
    type(snapshot_t), intent(inout) :: snapshot
    logical :: is_fixed(2, model%mesh%n_node)
    integer :: i

    if (size(snapshot%supports) == 0) return
    is_fixed = .false.
    do i = 1, size(model%conditions%fixed_nodes)
      is_fixed(model%conditions%fixed_directions(i), model%conditions%fixed_nodes(i)) = .true.
    end do
    snapshot%reaction = merge(reaction(:, snapshot%supports), 0.0_wp, &
      is_fixed(:, snapshot%supports))
  end subroutine fill_reactions

  !> Reactions of the explicit method; a body load pulls at the mass of fixed nodes too.
  pure subroutine fill_explicit_reactions(model, state, snapshot, held)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp), intent(in), optional :: held(:, :) !! (2, n_skew) forces of skew supports on nodes
    real(wp) :: reaction(2, model%mesh%n_node)
    integer :: k

    if (size(snapshot%supports) == 0) return
    do k = 1, 2
      reaction(k, :) = state%internal_force(k, :) - state%mass*state%body_acceleration(k)
    end do
    associate (n => model%layout%n_special)
      reaction(:, :n) = reaction(:, :n) - state%force_special(:, :n)
    end associate
    call fill_reactions(model, reaction, snapshot)
    if (present(held)) call add_skew(model, held, snapshot)
  end subroutine fill_explicit_reactions

  !> Forces of supports along axes that are neither x nor y.
  pure subroutine add_skew(model, held, snapshot)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: held(:, :)
    type(snapshot_t), intent(inout) :: snapshot
    integer :: row(model%mesh%n_node), i

    row = 0
    row(snapshot%supports) = [(i, i=1, size(snapshot%supports))]
    do i = 1, size(held, 2)
      associate (k => row(model%conditions%skew_supports(i)%node))
        if (k > 0) snapshot%reaction(:, k) = snapshot%reaction(:, k) + held(:, i)
      end associate
    end do
  end subroutine add_skew

end module support_forces_m
