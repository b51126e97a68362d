! SPDX-License-Identifier: MIT
!> D of each node where the deck damps parts (*DAMPING_PART_MASS): the mean over the masses that
!> elements bring to it, and those on nodes, which have the global damping alone. Nodes of a rigid
!> body have that of its part.
module node_damping_m
  use element_mass_m, only : element_shares
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use part_damping_m, only : damping_rates
  use state_m, only : state_t
  implicit none
  private
  public :: follow_damping

contains

  !> Form the rates of the nodes anew where those of parts have changed since, or `rates` is not
  !> there.
  subroutine follow_damping(model, rates, state)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(inout) :: rates(:, :)  !! (2, n_part + 1) as `damping_rates` has
                                                         !! them
    type(state_t), intent(inout) :: state
    real(wp) :: now(2, size(model%parts) + 1)
    integer :: i

    now = damping_rates(model, state%time)
    if (allocated(rates)) then
      if (all(abs(now - rates) <= 0.0_wp)) return
    end if
    rates = now
    call spread_rates(model, rates, state)
    do i = 1, size(model%rigids)
      state%node_damping(1, model%rigids(i)%nodes) = rates(1, model%rigids(i)%part)
      state%node_damping(2, model%rigids(i)%nodes) = rates(2, model%rigids(i)%part)
    end do
  end subroutine follow_damping

  !> The mean of the rates over the mass of each node.
  subroutine spread_rates(model, rates, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: rates(:, :)
    type(state_t), intent(inout) :: state
    real(wp) :: shares(4)
    integer :: slot, k

    state%node_damping = 0.0_wp
    if (allocated(model%conditions%lumped_masses)) then
      do k = 1, size(model%conditions%lumped_masses)
        associate (lump => model%conditions%lumped_masses(k))
          state%node_damping(:, lump%node) = state%node_damping(:, lump%node) &
            + lump%mass*rates(:, size(rates, 2))
        end associate
      end do
    end if
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      shares = element_shares(model, slot)
      if (allocated(state%elements%mass_ratio)) shares = state%elements%mass_ratio(slot)*shares
      do k = 1, 4
        associate (node => model%layout%slot_nodes(k, slot))
          state%node_damping(:, node) = state%node_damping(:, node) &
            + shares(k)*rates(:, slot_part(model%layout, slot))
        end associate
      end do
    end do
    do k = 1, size(state%mass)
      if (state%mass(k) > 0.0_wp) state%node_damping(:, k) = state%node_damping(:, k)/state%mass(k)
    end do
  end subroutine spread_rates

end module node_damping_m
