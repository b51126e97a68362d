! SPDX-License-Identifier: MIT
!> Hourglass control of the one-point quad, plane and axisymmetric, from the hourglass velocity
!> gamma.v: viscous or by stiffness (Flanagan & Belytschko 1981), or by assumed strain (Belytschko &
!> Bindeman 1991).
module hourglass_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use material_dispatch_m, only : find_failed
  use parts_m, only : hourglass_t, material_t, hourglass_viscous, hourglass_assumed, condensed_bulk
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: apply_hourglass_control, form_resistance, hourglass_viscous_force, &
    hourglass_stiffness_force, hourglass_assumed_strain, form_moduli, largest_spread

contains

  !> Hourglass forces of one chunk and their work.
  pure subroutine apply_hourglass_control(i_chunk, material, hourglass, stress, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y out
    real(wp) :: work
    integer :: i, x, y
    logical :: has_failed, failed(chunk_size), ignored

    x = elements%hourglass_start(i_chunk)
    y = x + chunk_size
    has_failed = .false.
    if (allocated(elements%n_failed)) has_failed = elements%n_failed(i_chunk) > 0
    associate (memory => elements%hourglass_strain)
      if (has_failed) then
        ! Failed elements have no hourglass velocity. In the step of failure the previous force
        ! still does work.
        call find_failed(material, elements%history(elements%history_start(i_chunk)), failed, &
          ignored)
        where (failed .and. .not. abs(memory(x:x + chunk_size - 1)) &
          + abs(memory(y:y + chunk_size - 1)) > 0.0_wp)
          chunk%gx = 0.0_wp
          chunk%gy = 0.0_wp
        end where
      end if
      if (hourglass%form == hourglass_assumed) then
        if (chunk%is_axisymmetric) call form_resistance(material, hourglass, chunk)
        call hourglass_assumed_strain(material, hourglass, stress, memory(x), memory(y), chunk, &
          work)
      else
        call form_resistance(material, hourglass, chunk)
        if (hourglass%form == hourglass_viscous) then
          call hourglass_viscous_force(stress%dt, memory(x), memory(y), chunk, work)
        else
          call hourglass_stiffness_force(stress%dt, stress, memory(x), memory(y), chunk, work)
        end if
      end if
      if (has_failed) then
        ! At the end of the step of failure the force does no work.
        do i = 1, chunk_size
          if (.not. failed(i)) cycle
          chunk%hourglass_work(i) = chunk%hourglass_work(i) - 0.5_wp*stress%dt*(chunk%qx(i) &
            *chunk%gx(i) + chunk%qy(i)*chunk%gy(i))
          chunk%qx(i) = 0.0_wp
          chunk%qy(i) = 0.0_wp
          memory([x + i - 1, y + i - 1]) = 0.0_wp
        end do
        work = sum(chunk%hourglass_work)
      end if
    end associate
    elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) + work
    if (allocated(elements%erosion)) then
      ! Per element, with erosion.
      associate (first => (i_chunk - 1)*chunk_size + 1)
        associate (works => elements%erosion%hourglass(first:first + chunk_size - 1))
          works = works + chunk%hourglass_work
        end associate
      end associate
    end if
  end subroutine apply_hourglass_control

  !> Force over gamma.v, (Q_h rho c sqrt(A)/4); or over its integral,
  !> (Q_h/4)(K + 4G/3)((B_x.B_x + B_y.B_y)/A); or a bound of that for assumed strain,
  !> QM E/(16 (1 - nu^2)) (2/(3A)) S with S the spread of the diagonals, which axisymmetric bodies
  !> alone need. In axisymmetric bodies all of them times V/A.
  pure subroutine form_resistance(material, hourglass, chunk)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(element_chunk_t), intent(inout) :: chunk !! `resistance` out
    real(wp) :: factor, lateral
    integer :: i

    if (hourglass%form == hourglass_viscous) then
      factor = 0.25_wp*hourglass%coefficient*material%density*material%sound_speed
      if (chunk%is_axisymmetric) then
        !$omp simd
        do i = 1, chunk_size
          chunk%resistance(i) = factor*chunk%volume(i)*(chunk%inverse_area(i)*sqrt(chunk%area(i)))
        end do
      else
        !$omp simd
        do i = 1, chunk_size
          chunk%resistance(i) = factor*sqrt(abs(chunk%area(i)))
        end do
      end if
      return
    end if
    if (hourglass%form == hourglass_assumed) then
      call form_moduli(material, hourglass, factor, lateral)
      factor = factor*2.0_wp/3.0_wp
      !$omp simd
      do i = 1, chunk_size
        chunk%resistance(i) = factor*largest_spread(chunk%x31(i), chunk%y31(i), chunk%x42(i), &
          chunk%y42(i))
      end do
    else
      factor = 0.125_wp*hourglass%coefficient*(material%bulk + 4.0_wp*material%shear/3.0_wp)
      if (material%is_plane_stress) factor = 0.125_wp*hourglass%coefficient &
        *(condensed_bulk(material%bulk, material%shear) + 4.0_wp*material%shear/3.0_wp)
      !$omp simd
      do i = 1, chunk_size
        chunk%resistance(i) = factor*(chunk%x31(i)**2 + chunk%y31(i)**2 + chunk%x42(i)**2 &
          + chunk%y42(i)**2)
      end do
    end if
    if (chunk%is_axisymmetric) then
      chunk%resistance = chunk%resistance*chunk%volume*chunk%inverse_area**2
    else
      chunk%resistance = chunk%resistance*chunk%inverse_area
    end if
  end subroutine form_resistance

  !> Viscous form. The work is that of the mean of the present and the previous force: a force acts
  !> over half of the step that it was formed from and half of the next.
  pure subroutine hourglass_viscous_force(dt, last_x, last_y, chunk, work)
    real(wp), intent(in) :: dt
    real(wp), intent(inout), dimension(chunk_size) :: last_x, last_y !! q of the previous step in,
                                                                     !! of this one out
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y and their work out
    real(wp), intent(out) :: work                 !! of all of them in the step
    integer :: i

    work = 0.0_wp
    !$omp simd reduction(+ : work)
    do i = 1, chunk_size
      chunk%qx(i) = chunk%resistance(i)*chunk%gx(i)
      chunk%qy(i) = chunk%resistance(i)*chunk%gy(i)
      chunk%hourglass_work(i) = 0.5_wp*dt*((last_x(i) + chunk%qx(i))*chunk%gx(i) &
        + (last_y(i) + chunk%qy(i))*chunk%gy(i))
      last_x(i) = chunk%qx(i)
      last_y(i) = chunk%qy(i)
      work = work + chunk%hourglass_work(i)
    end do
  end subroutine hourglass_viscous_force

  !> Stiffness form: the hourglass strain e rotates with the element. With the rotation R of the
  !> step, e' = R e + (1 + R) dt g/2: gamma.v is of the mid-step frame, half a rotation back, and (1
  !> + R)/2 is that half rotation times its cosine, by which gamma.v of a rotating element is too
  !> large. So a pattern that grows while its element rotates is kept without error for any step,
  !> and no step divides by zero.
  pure subroutine hourglass_stiffness_force(dt, stress, strain_x, strain_y, chunk, work)
    real(wp), intent(in) :: dt
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    real(wp), intent(inout), dimension(chunk_size) :: strain_x, strain_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y and their work out
    real(wp), intent(out) :: work                   !! of all of them in the step
    real(wp) :: half_x, half_y, old_x, old_y, growth_x, growth_y
    integer :: i

    work = 0.0_wp
    !$omp simd private(half_x, half_y, old_x, old_y, growth_x, growth_y) reduction(+ : work)
    do i = 1, chunk_size
      half_x = 0.5_wp*dt*chunk%gx(i)
      half_y = 0.5_wp*dt*chunk%gy(i)
      old_x = stress%cosine(i)*strain_x(i) - stress%sine(i)*strain_y(i)
      old_y = stress%sine(i)*strain_x(i) + stress%cosine(i)*strain_y(i)
      growth_x = half_x + (stress%cosine(i)*half_x - stress%sine(i)*half_y)
      growth_y = half_y + (stress%sine(i)*half_x + stress%cosine(i)*half_y)
      strain_x(i) = old_x + growth_x
      strain_y(i) = old_y + growth_y
      chunk%qx(i) = chunk%resistance(i)*strain_x(i)
      chunk%qy(i) = chunk%resistance(i)*strain_y(i)
      chunk%hourglass_work(i) = 0.5_wp*chunk%resistance(i)*((strain_x(i) + old_x)*growth_x &
        + (strain_y(i) + old_y)*growth_y)
      work = work + chunk%hourglass_work(i)
    end do
  end subroutine hourglass_stiffness_force

  !> Assumed strain (Belytschko & Bindeman 1991, optimal bending field): the elastic stress of the
  !> hourglass strain in a frame that rotates with the element, integrated in closed form
  !> (doc/theory/elements.md, "Assumed strain"). Steps the generalised stress Q of the element's
  !> frame,
  !>  Q' = factor [H_xx, -lateral H_xy; -lateral H_xy, H_yy] (gamma.v in that frame),
  !> with H of the mid-step shape, so that a motion and its reverse leave nothing.
  pure subroutine hourglass_assumed_strain(material, hourglass, stress, stress_x, stress_y, chunk, &
    work)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress      !! step, and rotation in it
    real(wp), intent(inout), dimension(chunk_size) :: stress_x, stress_y !! Q
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y out, per unit of depth; their work
    real(wp), intent(out) :: work                   !! of all of them in the step
    real(wp) :: factor, lateral, back, x31, y31, x42, y42, cosine, sine, scale, area, weight, mxx, &
      mxy, myy, half, grown_x, grown_y, added_x, added_y
    integer :: i

    call form_moduli(material, hourglass, factor, lateral)
    back = 0.5_wp*stress%dt
    work = 0.0_wp
    !$omp simd private(x31, y31, x42, y42, cosine, sine, scale, area, weight, mxx, mxy, myy, half, &
    !$omp& grown_x, grown_y, added_x, added_y) reduction(+ : work)
    do i = 1, chunk_size
      x31 = chunk%x31(i) - back*chunk%v31(1, i)
      y31 = chunk%y31(i) - back*chunk%v31(2, i)
      x42 = chunk%x42(i) - back*chunk%v42(1, i)
      y42 = chunk%y42(i) - back*chunk%v42(2, i)
      area = 0.5_wp*(x31*y42 - x42*y31)
      ! The frame: rotation of the polar decomposition of the mean Jacobian.
      cosine = (x31 - x42) + (y31 + y42)
      sine = (y31 - y42) - (x31 + x42)
      scale = 1.0_wp/sqrt(cosine*cosine + sine*sine)
      cosine = scale*cosine
      sine = scale*sine
      added_x = cosine*x31 + sine*y31
      added_y = cosine*y31 - sine*x31
      grown_x = cosine*x42 + sine*y42
      grown_y = cosine*y42 - sine*x42
      weight = 2.0_wp*factor/(3.0_wp*area)
      mxx = weight*(added_y*added_y + grown_y*grown_y)
      myy = weight*(added_x*added_x + grown_x*grown_x)
      mxy = weight*lateral*(added_x*added_y + grown_x*grown_y)
      grown_x = cosine*chunk%gx(i) + sine*chunk%gy(i)
      grown_y = cosine*chunk%gy(i) - sine*chunk%gx(i)
      ! gamma.v of a rotating element is too large by 1/cos(half the angle).
      half = stress%dt*sqrt(0.5_wp + 0.5_wp*stress%cosine(i))
      grown_x = half*grown_x
      grown_y = half*grown_y
      cosine = (chunk%x31(i) - chunk%x42(i)) + (chunk%y31(i) + chunk%y42(i))
      sine = (chunk%y31(i) - chunk%y42(i)) - (chunk%x31(i) + chunk%x42(i))
      scale = 1.0_wp/sqrt(cosine*cosine + sine*sine)
      cosine = scale*cosine
      sine = scale*sine
      added_x = mxx*grown_x + mxy*grown_y
      added_y = mxy*grown_x + myy*grown_y
      ! In axisymmetric bodies `mid_area` is the volume per radian.
      chunk%hourglass_work(i) = chunk%mid_area(i)/area*((stress_x(i) + 0.5_wp*added_x)*grown_x &
        + (stress_y(i) + 0.5_wp*added_y)*grown_y)
      work = work + chunk%hourglass_work(i)
      stress_x(i) = stress_x(i) + added_x
      stress_y(i) = stress_y(i) + added_y
      chunk%qx(i) = cosine*stress_x(i) - sine*stress_y(i)
      chunk%qy(i) = sine*stress_x(i) + cosine*stress_y(i)
    end do
    if (.not. chunk%is_axisymmetric) return
    ! The force of the plane times the mean radius V/A.
    !$omp simd private(weight)
    do i = 1, chunk_size
      weight = chunk%volume(i)*chunk%inverse_area(i)
      chunk%qx(i) = weight*chunk%qx(i)
      chunk%qy(i) = weight*chunk%qy(i)
    end do
  end subroutine hourglass_assumed_strain

  !> QM E/(16 (1 - nu^2)) and nu/(1 - nu); in plane stress QM E/16 and nu.
  pure subroutine form_moduli(material, hourglass, factor, lateral)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(out) :: factor, lateral
    real(wp) :: wave

    wave = 3.0_wp*material%bulk + 4.0_wp*material%shear
    factor = 0.25_wp*hourglass%coefficient*material%shear*(3.0_wp*material%bulk + material%shear) &
      /wave
    lateral = (3.0_wp*material%bulk - 2.0_wp*material%shear)/wave
    if (.not. material%is_plane_stress) return
    factor = hourglass%coefficient*material%young/16.0_wp
    lateral = material%poisson
  end subroutine form_moduli

  !> Larger eigenvalue of d31 d31 + d42 d42 (dyads): H, and with it the stiffness over `factor`,
  !> has none above 2/(3A) of it.
  pure elemental function largest_spread(x31, y31, x42, y42) result(spread)
    !$omp declare simd(largest_spread)
    real(wp), intent(in) :: x31, y31, x42, y42
    real(wp) :: spread
    real(wp) :: xx, yy, xy

    xx = x31*x31 + x42*x42
    yy = y31*y31 + y42*y42
    xy = x31*y31 + x42*y42
    spread = 0.5_wp*((xx + yy) + sqrt((xx - yy)**2 + 4.0_wp*xy*xy))
  end function largest_spread

end module hourglass_m
