! SPDX-License-Identifier: MIT
!> Damping of points in contact (doc/theory/contact.md, section 6).
module damping_m
  use arc_points_m, only : last_of_virtual_node
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: damp_points, find_lag, of_stuck

  !> Damping of stuck springs as a fraction of critical, and what it may be times omega and the step
  !> (lagging by half a step it takes four times that off the square of what leap-frog bears).
  real(wp), parameter :: of_stuck = 0.5_wp, of_step = 0.15_wp

contains

  !> Add the damping of points in contact, -2 fraction k/omega times the opening velocity, with
  !> omega^2 = sum of w K/m over the nodes of both sides, where K is the sum of all springs at a
  !> node. For two masses and one spring it is the fraction of critical, and it does not depend on
  !> how many points share a node's spring. The total never pulls. What is added is kept as well.
  pure subroutine damp_points(points, fraction, nodes, motion, mass, is_self, nodal)
    type(contact_points_t), intent(inout) :: points
    real(wp), intent(in) :: fraction
    integer, intent(in), contiguous :: nodes(:)      !! mesh index of each local node
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u and v
    real(wp), intent(in), contiguous :: mass(:)      !! (n_node) kg/m
    logical, intent(in) :: is_self !! each node is slave and master
    real(wp), intent(inout), contiguous :: nodal(:, :) !! (2, local nodes) scratch
    real(wp) :: rate, damped
    integer :: p, last

    call sum_springs(points, is_self, nodal)
    points%damping(:points%n) = 0.0_wp
    p = 1
    do while (p <= points%n)
      ! Sub-segments damped one by one would brake a rotation of all.
      last = last_of_virtual_node(points, p)
      if (points%pressure(p)*sum(points%area(p:last)) > 0.0_wp) then
        rate = opening_rate(points, p, last, nodes, motion)
        damped = max(0.0_wp, points%pressure(p) &
          - 2.0_wp*fraction*rate*points%stiffness(p)/frequency(points, p, last, nodes, mass, nodal))
        points%damping(p:last) = damped - points%pressure(p)
        points%pressure(p:last) = damped
      end if
      p = last + 1
    end do
  end subroutine damp_points

  !> Opening velocity of a spring, the mean of its points by area, m/s.
  pure function opening_rate(points, first, last, nodes, motion) result(rate)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: first, last
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp) :: rate
    real(wp) :: velocity(2)
    integer :: p, k

    rate = 0.0_wp
    do p = first, last
      velocity = 0.0_wp
      do k = 1, n_side
        associate (a => nodes(points%slave_nodes(k, p)), b => nodes(points%master_nodes(k, p)))
          velocity = velocity + points%slave_weights(k, p)*motion(3:4, a)
          velocity = velocity - points%master_weights(k, p)*motion(3:4, b)
        end associate
      end do
      rate = rate + points%area(p)/sum(points%area(first:last)) &
        *dot_product(points%normal(:, p), velocity)
    end do
  end function opening_rate

  !> Damping over stiffness of tangential springs that stick, s: 2 fraction/omega with the largest
  !> omega of the points in contact, and no more than the step bears. Undamped they ring in what
  !> comes to stick, and it slips again before the traction that holds it has come to FS p.
  pure subroutine find_lag(points, nodes, mass, is_self, dt, nodal, lag)
    type(contact_points_t), intent(in) :: points
    integer, intent(in), contiguous :: nodes(:)    !! mesh index of each local node
    real(wp), intent(in), contiguous :: mass(:)    !! (n_node) kg/m
    logical, intent(in) :: is_self                 !! each node is slave and master
    real(wp), intent(in) :: dt                     !! step behind, s
    real(wp), intent(inout), contiguous :: nodal(:, :) !! (2, local nodes) scratch
    real(wp), intent(out) :: lag
    real(wp) :: omega
    integer :: p

    call sum_springs(points, is_self, nodal)
    omega = 0.0_wp
    do p = 1, points%n
      if (points%pressure(p)*points%area(p) > 0.0_wp) &
        omega = max(omega, frequency(points, p, p, nodes, mass, nodal))
    end do
    lag = 0.0_wp
    if (omega > 0.0_wp) lag = 2.0_wp*min(of_stuck, of_step/(omega*dt))/omega
  end subroutine find_lag

  !> The frequency of a spring: omega^2 = sum of w K/m, the mean of its points by area, 1/s.
  pure function frequency(points, first, last, nodes, mass, nodal) result(omega)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: first, last
    integer, intent(in), contiguous :: nodes(:)    !! mesh index of each local node
    real(wp), intent(in), contiguous :: mass(:)    !! (n_node) kg/m
    real(wp), intent(in), contiguous :: nodal(:, :) !! (1, :) K of the nodes, N/m
    real(wp) :: omega
    real(wp) :: square
    integer :: p, k

    omega = 0.0_wp
    do p = first, last
      square = 0.0_wp
      do k = 1, n_side
        associate (a => points%slave_nodes(k, p), b => points%master_nodes(k, p))
          square = square + points%slave_weights(k, p)*nodal(1, a)/mass(nodes(a))
          square = square + points%master_weights(k, p)*nodal(1, b)/mass(nodes(b))
        end associate
      end do
      omega = omega + points%area(p)/sum(points%area(first:last))*square
    end do
    omega = sqrt(omega)
  end function frequency

  !> Springs of all loaded points by node, N/m, into nodal(1, :): in two passes a node stands on
  !> either side.
  pure subroutine sum_springs(points, is_self, nodal)
    type(contact_points_t), intent(in) :: points
    logical, intent(in) :: is_self
    real(wp), intent(inout), contiguous :: nodal(:, :)
    real(wp) :: spring
    integer :: p, k

    nodal(1, :) = 0.0_wp
    do p = 1, points%n
      if (.not. points%pressure(p) > 0.0_wp) cycle
      spring = points%stiffness(p)*points%area(p)
      do k = 1, n_side
        nodal(1, points%slave_nodes(k, p)) = nodal(1, points%slave_nodes(k, p)) &
          + points%slave_weights(k, p)*spring
        nodal(1, points%master_nodes(k, p)) = nodal(1, points%master_nodes(k, p)) &
          + points%master_weights(k, p)*spring
      end do
    end do
    if (.not. is_self) return
    associate (n => size(nodal, 2)/2)
      nodal(1, :n) = nodal(1, :n) + nodal(1, n + 1:)
      nodal(1, n + 1:) = nodal(1, :n)
    end associate
  end subroutine sum_springs

end module damping_m
